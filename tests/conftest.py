"""The suite draws without a screen, and has three tiers.

`pytest` is the quick one: without what is marked `slow`, and of each battery, marked `random`, two items that rotate
with the day. `pytest --rest` is the day's rest: of what is slow a third in turn, so that three days run all of it, and
of each battery a fifth of what is left, four items at least, that rotate likewise. `pytest --everything` is all of it.
The seed is told at the head of a run; `--seed` repeats it.
"""

import datetime
import gc
import os
import random
import shutil
import zlib

import pytest

os.environ["MPLBACKEND"] = "Agg"

KEPT = 2  # of the items of a battery, in the quick tier
MORE, SHARE = 4, 5  # in the rest of the day so many more at least, or one of so many: all took 45 minutes
TURNS = 3  # days until every slow test has run: the whole gate took 39 minutes with all of them each day


def pytest_addoption(parser):
    group = parser.getgroup("tiers")
    group.addoption("--everything", action="store_true", help="all tests, also those marked slow, and whole batteries")
    group.addoption("--rest", action="store_true", help="a third of what is slow, and more of each battery")
    group.addoption("--seed", type=int, help="which items of the batteries are run, and what is made at random; today")


def pytest_configure(config):
    if config.option.seed is None:  # workers are given that of the run
        config.option.seed = datetime.date.today().toordinal()
    os.environ["RSYM_TEST_SEED"] = str(config.option.seed)
    os.environ["RSYM_TEST_TIER"] = "everything" if config.option.everything or config.option.rest else "quick"


def pytest_report_header(config):
    tier = "everything" if config.option.everything else "the rest of the day" if config.option.rest else "quick"
    return f"tier: {tier}; --seed {config.option.seed}"


def tiers(items, seed):
    """Those of the quick tier and those of the rest of the day, each in their order."""
    batteries = {}
    for item in items:
        if item.get_closest_marker("random") is not None:
            batteries.setdefault(item.nodeid.partition("[")[0], []).append(item)
    kept, more = set(), set()
    for name, battery in batteries.items():
        drawn = random.Random(f"{seed} {name}").sample(battery, len(battery))
        kept.update(drawn[:KEPT])
        more.update(drawn[KEPT : KEPT + max(MORE, len(battery) // SHARE)])
    rotating = {item for battery in batteries.values() for item in battery}
    slow = {item for item in items if item.get_closest_marker("slow") is not None}
    quick = [item for item in items if item not in slow and (item not in rotating or item in kept)]
    in_turn = {item for item in slow - rotating if (zlib.crc32(item.nodeid.encode()) + seed) % TURNS == 0}
    rest = [item for item in items if item in more or item in in_turn or (item in slow and item in kept)]
    return quick, rest


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
    quick, rest = tiers(items, config.option.seed)
    chosen = rest if config.option.rest else quick
    taken = set(chosen)
    dropped = [item for item in items if item not in taken]
    items[:] = chosen
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
