"""Counts what is checked, and says what failed."""

import traceback

passed = failed = 0


def check(name, truth, detail=""):
    global passed, failed
    if truth:
        passed += 1
    else:
        failed += 1
        print(f"FAILED: {name} {detail}", flush=True)


def run(tests):
    """Runs functions; one that raises is a failure, too."""
    for test in tests:
        try:
            test()
        except Exception:
            check(test.__name__, False, "raised\n" + traceback.format_exc())


def close():
    print(f"{passed} passed, {failed} failed", flush=True)
    return 1 if failed else 0
