"""Index loops of the mesher: compiled once on a machine, kept in the user's cache folder, run in threads.

numba's own cache writes beside the source file, trusts what it reads and looks only at the date of one file.
Here the name of an entry is a digest of the byte code of the loop and of everything it calls, of the types of its
arguments, of the processor and of the versions of Python and numba; so nothing old is ever run, and nothing is
compiled again because a file has moved.
"""

from __future__ import annotations

import hashlib
import io
import itertools
import logging
import pickle
import sys
from collections.abc import Callable, Iterator
from concurrent.futures import Executor
from functools import cache
from types import CodeType
from typing import Any, TypeVar, cast

import numba
import numpy as np
from numba import _dynfunc, njit, types
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase, CompileResult
from numba.core.compiler_machinery import PassManager, register_pass
from numba.core.runtime import rtsys
from numba.core.serialize import dumps
from numba.core.typed_passes import (
    IRLegalization,
    NativeLowering,
    NoPythonBackend,
    NopythonTypeInference,
    PreLowerStripPhis,
)
from numba.core.untyped_passes import FixupArgs, GenericRewrites, IRProcessing, ReconstructSSA, TranslateByteCode
from numba.extending import intrinsic

from rsym.backends.caches import cache_folder, keep_entry, read_entry
from rsym.backends.llvm_code import bitcode
from rsym.garbage import uncollected

F = TypeVar("F", bound=Callable[..., Any])
R = TypeVar("R")

logger = logging.getLogger(__name__)
NOTICE = "compiling the mesher's loops, once on this machine: some six seconds"
HOW = {"nogil": True, "error_model": "numpy", "no_cfunc_wrapper": True}  # no C code calls a loop: a tenth of the time
MAKERS = {"empty", "zeros", "full", "arange"}
KIND = "loops"
# LLVM 20 and 22 choose vectors of 512 bits for processors of kinds znver4 and znver5 alone, and there they turn int64
# into int8 wrongly: of `signs[k] = -turned[k]` for 32 leaves and more, the bytes of others came out as zero.
WIDTH = '"prefer-vector-width"="256"'
_COMPILED = itertools.count(1)


class LoopLibrary(JITCodeLibrary):  # type: ignore[misc]
    """Code of a loop, optimised once, as a whole: numba does so thrice, by function and cheaply before."""

    def add_ir_module(self, ir_module: Any) -> None:
        """Take code, all of it for vectors of the same width."""
        for function in ir_module.functions:
            set.add(function.attributes, WIDTH)  # the method of attributes takes those alone that have no value
        super().add_ir_module(ir_module)

    def _optimize_functions(self, ll_module: Any) -> None:
        ll_module.data_layout = self._codegen._data_layout

    def _optimize_final_module(self) -> None:
        passes, builder = self._codegen._module_pass_manager()
        passes.run(self._final_module, builder)


class StepLibrary(LoopLibrary):
    """Code of a step: it becomes a part of loops, is optimised there, and no machine ever runs it by itself."""

    def _optimize_final_module(self) -> None:
        pass

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._finalized = True


@register_pass(mutates_CFG=True, analysis_only=False)
class LoopLowering(NativeLowering):  # type: ignore[misc]
    """To LLVM, by libraries of our own."""

    _name = "loop_lowering"

    def run_pass(self, state: Any) -> bool:
        """Lower a loop, or a step, of which no machine code is made."""
        is_step = state.flags.no_compile = state.flags.no_cpython_wrapper
        kind = StepLibrary if is_step else LoopLibrary
        state.library = kind(state.targetctx.codegen(), state.func_id.func_qualname)
        state.library.enable_object_caching()
        super().run_pass(state)
        if is_step:
            # Loops find the code of a step by a function that stands for it; there is nothing to be called.
            described = state.cr.fndesc
            name = described.qualname.rpartition(".")[2]
            stands = _dynfunc.make_function(described.lookup_module(), name, "", 0, state.cr.env, (state.library,))
            state.targetctx.insert_user_function(stands, described, [state.library])
            state.cr = state.cr._replace(cfunc=stands)
        return True


# What plain loops need of numba's passes. Those left out are for closures, array expressions, parallel loops, and notes
# on types that nobody reads; they take some of the time, and change nothing here.
PASSES = (
    TranslateByteCode,
    FixupArgs,
    IRProcessing,
    GenericRewrites,
    ReconstructSSA,
    NopythonTypeInference,
    PreLowerStripPhis,
    IRLegalization,
    LoopLowering,
    NoPythonBackend,
)


class ShortCompiler(CompilerBase):  # type: ignore[misc]
    """numba's compiler, by the passes that loops need."""

    def define_pipelines(self) -> list[PassManager]:
        """The one way there is."""
        self.state.type_annotation = None
        passes = PassManager("loops")
        for one in PASSES:
            passes.add_pass(one, one.__name__)
        passes.finalize()
        return [passes]

    def _compile_core(self) -> Any:
        with uncollected():
            return super()._compile_core()


def loop(function: F) -> F:
    """Compile a loop that only Python calls: without the interpreter's lock, kept in the user's cache folder."""
    compiled = njit(pipeline_class=ShortCompiler, **HOW, **_how(function))(function)
    # The one place numba offers for a cache of one's own; its environment variables would move the user's caches too.
    compiled._cache = LoopCache(function)
    return cast(F, compiled)


def step(function: F) -> F:
    """Compile a function that only loops call: it is part of them and of their cache entries."""
    compiled = njit(no_cpython_wrapper=True, pipeline_class=ShortCompiler, **HOW, **_how(function))(function)
    template = compiled.get_call_template
    # One version for all whole numbers: a counter whose type is not inferred yet is the literal that it starts as.
    compiled.get_call_template = lambda args, keywords: template([*map(types.unliteral, args)], keywords)
    return cast(F, compiled)


def _how(function: Callable[..., Any]) -> dict[str, bool]:
    """Only where a loop makes arrays are references counted, of all arrays in it: a twelfth of the time to compile."""
    return {"_nrt": not MAKERS.isdisjoint(function.__code__.co_names)}


@intrinsic  # type: ignore[untyped-decorator]
def popcount(typing: Any, word: Any) -> Any:
    """Count the bits of a 64-bit word."""
    return types.uint64(types.uint64), lambda context, builder, signature, args: builder.ctpop(args[0])


@intrinsic  # type: ignore[untyped-decorator]
def lowest(typing: Any, word: Any) -> Any:
    """Find the number of the lowest bit of a 64-bit word that is set."""

    def generate(context: Any, builder: Any, signature: Any, args: Any) -> Any:
        return builder.cttz(args[0], context.get_constant(types.boolean, 1))

    return types.int64(types.uint64), generate


def in_threads(call: Callable[[int, int], R], count: int, grain: int, pool: Executor | None) -> list[R]:
    """Cover range(count) by ``call(first, last)`` over pieces of at least `grain`, run by the pool; answers in order.

    Where the pieces begin depends on count and grain alone, and is a multiple of 8.

    Examples
    --------
    >>> in_threads(lambda first, last: last - first, 100, 64, None)
    [100]
    """
    # 64 pieces leave little to wait for at the end on any number of threads, and cost 20 microseconds each.
    size = max(grain, -(-count // 512) * 8)
    if pool is None or count <= size:
        return [call(0, count)] if count else []
    return list(pool.map(lambda first: call(first, min(first + size, count)), range(0, count, size)))


class LoopCache:
    """What numba asks for compiled code of one function (the protocol of numba.core.caching._Cache)."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self._function = function

    @property
    def cache_path(self) -> str:
        """The folder of the entries."""
        return str(cache_folder(KIND))

    def load_overload(self, signature: Any, target: Any) -> Any:
        """Give the compiled loop for these types, or None."""
        # Enough for code that is compiled already; `target.refresh()`, for compiling, would load SciPy too: 0.25 s.
        rtsys.initialize(target)
        payload = read_entry(KIND, self._entry(signature, target.codegen()))
        if payload is None:
            _announce()
            logger.info("compiling loop %d: %s", next(_COMPILED), self._function.__name__.strip("_").replace("_", " "))
            return None
        return CompileResult._rebuild(target, *_Entry(io.BytesIO(payload)).load())

    def save_overload(self, signature: Any, compiled: Any) -> None:
        """Keep a compiled loop; a folder that cannot be written is no error."""
        if not compiled.library.has_dynamic_globals:
            (name, kind, (code, _)), *rest = compiled._reduce()
            # Beside the code numba keeps what could be linked into other loops: only the name of its entry is needed.
            known = bitcode(f'define void @"{compiled.fndesc.llvm_cpython_wrapper_name}"() {{ ret void }}')
            entry = (name, kind, (code, known)), *rest
            keep_entry(KIND, self._entry(signature, compiled.codegen), dumps(entry))

    def _entry(self, signature: Any, codegen: Any) -> str:
        how = HOW | _how(self._function)
        machine = (numba.__version__, sys.version, how, WIDTH, [one.__name__ for one in PASSES], _machine(codegen))
        digest = hashlib.sha256(repr((machine, str(signature), *_content(self._function, set()))).encode())
        return f"{self._function.__name__}-{digest.hexdigest()[:32]}"


@cache
def _machine(codegen: Any) -> Any:
    return codegen.magic_tuple()


class _Entry(pickle.Unpickler):
    """Without the modules that compiled code came from, which only uncompiled code looks into: 0.06 s for arrays."""

    def find_class(self, module: str, name: str) -> Any:
        found = super().find_class(module, name)
        return (lambda _, *rest: found(__name__, *rest)) if name == "_rebuild_env" else found


def _content(function: Any, seen: set[int]) -> Iterator[object]:
    """Everything that decides what a function compiles to: its byte code, constants, globals, and theirs."""
    plain = getattr(function, "py_func", None) or getattr(function, "_defn", None) or function
    if id(plain) in seen:
        return
    seen.add(id(plain))
    # Compiled code remembers the module that it came from.
    yield plain.__module__
    codes = [plain.__code__]
    for code in codes:
        codes += [constant for constant in code.co_consts if isinstance(constant, CodeType)]
        yield code.co_code, code.co_names, code.co_varnames
        yield [constant for constant in code.co_consts if not isinstance(constant, CodeType)]
        for name in code.co_names:
            value = plain.__globals__.get(name)
            if isinstance(value, np.ndarray):
                yield name, value.dtype.str, value.shape, value.tobytes()
            elif hasattr(value, "py_func") or hasattr(value, "_defn"):
                yield from _content(value, seen)
            elif isinstance(value, (bool, int, float, tuple, np.generic)):
                yield name, repr(value)


@cache
def _announce() -> None:
    logger.warning(NOTICE)
