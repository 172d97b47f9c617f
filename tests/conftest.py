"""The suite draws without a screen, and has two tiers.

`pytest` is the quick one: without what is marked `slow`, and of each battery, marked `random`, two items that rotate
with the day. `pytest --everything` is all of it, `pytest --rest` what the quick one leaves out. The seed is told at the
head of a run; `--seed` repeats it.
"""

import datetime
import gc
import os
import random
import shutil

import pytest

os.environ["MPLBACKEND"] = "Agg"

KEPT = 2  # of the items of a battery


def pytest_addoption(parser):
    group = parser.getgroup("tiers")
    group.addoption("--everything", action="store_true", help="all tests, also those marked slow, and whole batteries")
    group.addoption("--rest", action="store_true", help="what a run without --everything leaves out, and nothing else")
    group.addoption("--seed", type=int, help="which items of the batteries are run, and what is made at random; today")


def pytest_configure(config):
    if config.option.seed is None:  # workers are given that of the run
        config.option.seed = datetime.date.today().toordinal()
    os.environ["RSYM_TEST_SEED"] = str(config.option.seed)
    os.environ["RSYM_TEST_TIER"] = "everything" if config.option.everything or config.option.rest else "quick"


def pytest_report_header(config):
    tier = (
        "everything"
        if config.option.everything
        else "what the quick tier leaves out"
        if config.option.rest
        else "quick"
    )
    return f"tier: {tier}; --seed {config.option.seed}"


def quick(items, seed):
    """Those of the quick tier, in their order."""
    batteries = {}
    for item in items:
        if item.get_closest_marker("random") is not None:
            batteries.setdefault(item.nodeid.partition("[")[0], []).append(item)
    kept = set()
    for name, battery in batteries.items():
        kept.update(random.Random(f"{seed} {name}").sample(battery, min(KEPT, len(battery))))
    rotating = {item for battery in batteries.values() for item in battery}
    return [
        item for item in items if item.get_closest_marker("slow") is None and (item not in rotating or item in kept)
    ]


@pytest.hookimpl(wrapper=True)
def pytest_collection():
    """What is collected lives as long as the run: to look for garbage in it, again and again, took a tenth of it."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.freeze()
        gc.set_threshold(100_000, 20, 20)
        gc.enable()


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(config, items):
    if config.option.everything or any("::" in name for name in config.args):
        return  # a test that is asked for by its name is run
    chosen = quick(items, config.option.seed)
    taken = set(chosen)
    left = [item for item in items if item not in taken]
    items[:], dropped = (left, chosen) if config.option.rest else (chosen, left)
    config.hook.pytest_deselected(items=dropped)


# The browser that pages are opened in: the system's Chromium, driven by Playwright; only CI insists on one.
FLAGS = (
    "--no-sandbox --disable-gpu --enable-unsafe-swiftshader --disable-quic --no-first-run "
    "--disable-background-networking --disable-component-update --disable-sync"
).split()


@pytest.fixture(scope="session")
def browser():
    found = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
    if found is None and not os.environ.get("CI"):
        pytest.skip("no Chromium here")
    assert found, "CI installs Chromium"
    from playwright import sync_api

    with sync_api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=found, args=FLAGS)
        yield browser
        browser.close()
