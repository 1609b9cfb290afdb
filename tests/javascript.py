"""JavaScript of the pages, run as a test needs it: in Node where it is present, else in a Chromium by Playwright."""

import importlib.util
import json
import shutil
import subprocess

import pytest

PATIENCE = 200_000  # ms, of a browser on a busy machine
LOCAL = ("file:", "blob:", "data:")
NEEDED = "needs Node, or Playwright (pip install playwright) and a Chromium"


def chromium():
    """Path of a Chromium that Playwright can drive, or None."""
    if importlib.util.find_spec("playwright") is None:
        return None
    return shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")


def quiet_page(context):
    """(a page, list of what it does that it must not: requests that leave the machine, errors) in a browser context."""
    page, wrong = context.new_page(), []
    page.set_default_timeout(PATIENCE)
    page.on("request", lambda request: None if request.url.startswith(LOCAL) else wrong.append(request.url))
    page.on("pageerror", lambda error: wrong.append(str(error)))
    return page, wrong


def evaluate(source, expression, data=None):
    """Value of a JavaScript `expression` after the scripts `source`, with `data` as DATA; skips without an engine."""
    script = f"{source}\nconst DATA = {json.dumps(data)};\n"
    if node := shutil.which("node"):
        script += f"process.stdout.write(JSON.stringify({expression}));"
        return json.loads(subprocess.check_output([node, "-"], input=script, text=True, timeout=120))
    if not (path := chromium()):
        pytest.skip(NEEDED)
    from playwright.sync_api import sync_playwright

    with sync_playwright() as play:
        page = play.chromium.launch(executable_path=path, args=["--no-sandbox"]).new_page()
        return page.evaluate(f"() => {{ {script} return {expression}; }}")
