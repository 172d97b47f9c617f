"""Whether points are inside, where omega does not say it."""

from __future__ import annotations

from rsym.backends.kernel import Kernel, compile, compile_program
from rsym.logic.sign_form import known_form
from rsym.model.recent import recently
from rsym.model.shape import Shape


@recently(16)
def known_kernel(shape: Shape) -> Kernel | None:
    """The value of the form of a shape of which omega does not say where it is (`known_form`); None of others."""
    form = known_form(shape)
    return None if form is None else compile_program(form.builder.program({"value": form.value}), ("value",), shape)


def inside_kernel(shape: Shape) -> Kernel:
    """A kernel whose value is positive inside, negative outside: that of omega as a rule."""
    return known_kernel(shape) or compile(shape)
