#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Watches a render on the page of `--preview web` in headless Chromium: the picture, its exposure,
the error over time; what another site can do; and the button. Exit code 77: there is no Chromium.

    tests/commands/preview_page.py PATH-OF-LUCERNA
"""
import http.server
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import threading
import time

SCENE = pathlib.Path(__file__).resolve().parents[2] / "scenes/cornell-box/scene.xml"
PATIENCE = 60  # [s]

# What a page of another site can try, if it has even learnt the address.
ATTACK = """<!DOCTYPE html><title>attack</title><iframe name="frame"></iframe>
<form method="post" target="frame" action="URLstop"></form>
<iframe id="embedded" src="URL"></iframe>
<script>
(async () => {
    const results = {};
    const attempt = async (name, path, options) => {
        try {
            const answer = await fetch("URL" + path, options);
            results[name] = answer.type === "opaque" ? "opaque" : "read";
        } catch { results[name] = "refused"; }
    };
    await attempt("status", "status");
    await attempt("picture", "picture");
    await attempt("post", "stop", {method: "POST"});
    await attempt("blind post", "stop", {method: "POST", mode: "no-cors"});
    navigator.sendBeacon("URLstop", "");
    document.forms[0].submit();
    await new Promise((resolve) => setTimeout(resolve, 1000));
    results.embedded = document.getElementById("embedded").contentDocument ? "read" : "refused";
    window.results = results;
})();
</script>"""


class Browser:
    """Chromium, spoken to by the DevTools protocol over a pair of pipes."""

    def __init__(self, program, profile):
        to_browser, self.to_browser = os.pipe()
        self.from_browser, from_browser = os.pipe()
        words = [program, "--headless", "--remote-debugging-pipe", "--disable-gpu",
                 "--disable-quic", "--no-first-run", "--disable-background-networking",
                 "--disable-component-update", "--disable-sync", f"--user-data-dir={profile}",
                 "--window-size=1200,900"]
        if os.getuid() == 0:
            words.append("--no-sandbox")  # root, as in containers, has none

        def give_pipes():
            # Above 4 first, lest one is closed by the other's number.
            ends = [os.dup(to_browser), os.dup(from_browser)]
            os.dup2(ends[0], 3)
            os.dup2(ends[1], 4)

        self.process = subprocess.Popen(words, preexec_fn=give_pipes, close_fds=False,
                                        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(to_browser)
        os.close(from_browser)
        self.number, self.unread, self.problems = 0, b"", []

    def call(self, method, session=None, **parameters):
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters}
        if session:
            message["sessionId"] = session
        os.write(self.to_browser, json.dumps(message).encode() + b"\0")
        while True:
            answer = self.read()
            if answer.get("id") == self.number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']}")
                return answer["result"]
            if answer.get("method") == "Runtime.exceptionThrown":
                self.problems.append(str(answer["params"]["exceptionDetails"]))
            entry = answer.get("params", {}).get("entry", {})
            if entry.get("level") == "error":
                self.problems.append(entry["text"])

    def read(self):
        while b"\0" not in self.unread:
            data = os.read(self.from_browser, 1 << 16)
            if not data:
                raise RuntimeError("Chromium has ended")
            self.unread += data
        message, self.unread = self.unread.split(b"\0", 1)
        return json.loads(message)

    def open(self, url, listen):
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        if listen:
            self.call("Runtime.enable", session)
            self.call("Log.enable", session)
        self.call("Page.navigate", session, url=url)
        return session

    def value(self, session, expression):
        result = self.call("Runtime.evaluate", session, expression=expression, returnByValue=True)
        return result["result"].get("value")

    def wait(self, session, expression):
        """The value of an expression, once it is true."""
        end = time.monotonic() + PATIENCE
        while time.monotonic() < end:
            value = self.value(session, expression)
            if value:
                return value
            time.sleep(0.1)
        sys.exit(f"FAILED: not within {PATIENCE} s: {expression}")

    def click(self, session, element):
        x, y = self.value(session, f"""(() => {{
            const box = document.getElementById("{element}").getBoundingClientRect();
            return [box.left + box.width / 2, box.top + box.height / 2];
        }})()""")
        for kind in ("mousePressed", "mouseReleased"):
            self.call("Input.dispatchMouseEvent", session, type=kind, x=x, y=y, button="left",
                      clickCount=1)


def expect(condition, text):
    if not condition:
        sys.exit(f"FAILED: expected {text}")


def serve(page):
    """Another site: its address."""

    class Handler(http.server.BaseHTTPRequestHandler):
        def do_GET(self):
            self.send_response(200)
            self.send_header("Content-Type", "text/html")
            self.end_headers()
            self.wfile.write(page.encode())

        def log_message(self, *_):
            pass

    server = http.server.ThreadingHTTPServer(("127.0.0.1", 0), Handler)
    threading.Thread(target=server.serve_forever, daemon=True).start()
    return f"http://127.0.0.1:{server.server_port}/"


def start_render(lucerna, folder):
    errors = folder / "errors.txt"
    render = subprocess.Popen(
        [lucerna, "render", SCENE, "--resolution", "60x40", "--time", "600", "--preview", "web",
         "-q", "-o", folder / "picture"], stderr=errors.open("w"), stdout=subprocess.DEVNULL)
    end = time.monotonic() + PATIENCE
    while time.monotonic() < end:
        found = re.search(r"preview: (\S+)\n", errors.read_text())
        if found:
            return render, found[1]
        time.sleep(0.05)
    sys.exit("FAILED: no address of a preview")


def check_page(browser, page):
    picture = "document.getElementById('picture')"
    browser.wait(page, f"{picture}.width === 60 && {picture}.height === 40")
    pixels = f"Array.from({picture}.getContext('2d').getImageData(0, 0, 60, 40).data).join()"
    before = browser.value(page, pixels)
    expect(len(set(before.split(","))) > 20, "a picture with many shades")
    browser.wait(page, "(document.querySelector('polyline')?.points.length ?? 0) >= 3")
    for element in ("left", "seconds", "samples", "rays", "error", "interval"):
        text = browser.value(page, f"document.getElementById('{element}').textContent")
        expect(re.search(r"\d", text), f"a number in {element}, not {text}")
    expect(browser.value(page, "document.getElementById('state').textContent") == "rendering",
           "a render that goes on")
    browser.value(page, """(() => {
        const slider = document.getElementById("exposure");
        slider.value = 3;
        slider.dispatchEvent(new Event("input"));
    })()""")
    shades = [sum(map(int, text.split(","))) for text in (before, browser.value(page, pixels))]
    expect(shades[1] > 1.2 * shades[0], "exposure to brighten the picture")
    expect(browser.value(page, "document.getElementById('exposure-value').textContent") == "+3 EV",
           "the exposure to be shown")


def check_other_site(browser, url, render):
    session = browser.open(serve(ATTACK.replace("URL", url)), listen=False)
    results = browser.wait(session, "window.results")
    expect(results == {"status": "refused", "picture": "refused", "post": "refused",
                       "blind post": results["blind post"], "embedded": "refused"},
           f"another site to learn nothing: {results}")
    expect(render.poll() is None, "another site not to stop the render")


def check_end(browser, page, render, folder):
    browser.click(page, "stop")
    browser.wait(page, "document.getElementById('state').textContent === 'finished'")
    text = browser.wait(page, "!document.getElementById('figures').hidden && "
                              "document.getElementById('figures').textContent")
    expect(" spp; " in text and "relMSE" in text, f"the last figures, not {text}")
    expect(render.wait(PATIENCE) == 130, "the exit code of an interrupted render")
    expect((folder / "picture.exr").stat().st_size > 0, "a picture")
    expect(browser.value(page, "document.getElementById('stop').disabled"), "no button any more")


def main():
    lucerna = pathlib.Path(sys.argv[1]).resolve()
    chromium = next(filter(None, map(shutil.which, (
        "chromium", "chromium-browser", "google-chrome"))), None)
    if not chromium:
        print("skipped: Chromium is not installed (package chromium)")
        sys.exit(77)
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as scratch:
        folder = pathlib.Path(scratch)
        render, url = start_render(lucerna, folder)
        browser = Browser(chromium, folder / "profile")
        try:
            page = browser.open(url, listen=True)
            check_page(browser, page)
            check_other_site(browser, url, render)
            check_end(browser, page, render, folder)
            expect(not browser.problems, f"no errors on the page: {browser.problems}")
        finally:
            browser.process.kill()
            browser.process.wait()
            render.kill()
    print("PASSED")


main()
