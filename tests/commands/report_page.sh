#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Opens the page of a small comparison, made in parts, in headless Chromium: no errors, no network,
# a chart, machines, and pictures that flip, split, and change with exposure. Exit code 77: there is
# no Chromium.
#
#   tests/commands/report_page.sh PATH-OF-LUCERNA
set -euo pipefail
root=$(dirname -- "$(dirname -- "$(dirname -- "$(readlink -f -- "$0")")")")
lucerna=$(readlink -f -- "$1")
chromium=$(command -v chromium || command -v chromium-browser || command -v google-chrome || true)
if [[ -z $chromium ]]; then
    echo "skipped: Chromium is not installed (package chromium)"
    exit 77
fi
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

"$lucerna" compare "$root/scenes/cornell-box/scene.xml" --resolution 48x40 --spp 2 --repeats 3 \
    --vary integrator.light_sampler=uniform,power,exhaustive --quiet -o "$scratch/out" --parts
"$lucerna" farm "$scratch/out" --local 2 --quiet

# A copy of the page with an ear for errors at its head and a visitor at its end.
cat > "$scratch/head.html" << 'END'
<script>
const problems = [];
addEventListener("error", (event) => problems.push(event.message || "a resource failed"));
addEventListener("securitypolicyviolation", (event) => problems.push("CSP: " + event.blockedURI));
for (const name of ["error", "warn"]) console[name] = (...words) => problems.push(words.join(" "));
</script>
END
cat > "$scratch/visitor.html" << 'END'
<script>
function expect(condition, text) { if (!condition) problems.push("expected: " + text); }
function press(key) {
    const options = {key, bubbles: true, cancelable: true};
    document.body.dispatchEvent(new KeyboardEvent("keydown", options));
    draw();
    return view.toDataURL();
}
function inked(canvas) {
    const {data} = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    return data.some((value, i) => i % 4 === 3 && value > 0);
}
function visit() {
    const chart = Chart.getChart("chart");
    expect(inked(chart.canvas), "a chart that is drawn");
    for (const [id, values] of [["curve-metric", ["mse", "trimmed_relative_mse", "relative_mse"]],
                                ["curve-axis", ["samples_per_pixel", "render_seconds"]]]) {
        for (const value of values) {
            element(id).value = value;
            element(id).dispatchEvent(new Event("change"));
            expect(inked(chart.canvas), "a chart for " + value);
        }
    }
    element("curve-axis").value = "samples_per_pixel";
    element("curve-axis").dispatchEvent(new Event("change"));
    expect(chart.data.datasets.length === 13, "four data sets for each variant, and the guide");
    expect(chart.data.datasets[0].data.length > 10, "a curve");
    expect(element("table").rows.length === 4, "a row for each variant");
    expect(!element("machines").hidden && element("machines-table").rows.length === 4,
           "a row for the machine of each round");

    const seen = new Set();
    for (const key of ["0", "1", "2", "3"]) {
        seen.add(press(key));
        const tab = document.querySelector('[role="tab"][aria-selected="true"]');
        expect(tab === element("tabs").children[Number(key)], "tab " + key + " to be selected");
    }
    expect(seen.size === 4, "four different pictures");
    const before = press("1");
    press("2");
    expect(press(" ") === before, "space to go back");
    expect(press("+") !== before, "exposure to change the picture");
    expect(press("-") === before, "exposure to change it back");
    expect(press("e") !== before, "an error map");
    press("e");
    expect(press("s") !== before && !element("divider").hidden, "a split picture");
    press("s");
    const box = stage.getBoundingClientRect();
    const clientX = box.left + box.width / 2, clientY = box.top + box.height / 2;
    const place = {clientX, clientY, bubbles: true};
    stage.dispatchEvent(new PointerEvent("pointermove", place));
    draw();
    const cells = [...element("pixel").rows[1].cells].slice(1, 4);
    const numbers = cells.map((cell) => Number(cell.textContent));
    const index = 3 * (state.pixel[1] * width + state.pixel[0]);
    const near = (x, y) => Math.abs(x - y) <= 1e-3 * Math.abs(x);
    expect(numbers.every((x, c) => near(x, pictures[0].values[index + c])),
           "pixel values under the pointer");
    const zoom = state.zoom;
    stage.dispatchEvent(new WheelEvent("wheel", {...place, deltaY: -600, cancelable: true}));
    draw();
    expect(state.zoom > 2 * zoom, "the wheel to zoom");
    expect(press("r") === before, "r to fit the picture again");
    expect(element("maps").children.length === 3, "three error maps");
    const ours = pictures[1].errors.reduce((a, b) => a + b, 0) / (width * height);
    const theirs = report.variants[0].runs[0].measured_relative_mse;
    expect(Math.abs(ours - theirs) < 0.01 * theirs, "relMSE of the page to be that of the program");
    expect(performance.getEntriesByType("resource").length === 0, "no request");
}
try { visit(); } catch (error) { problems.push(String(error)); }
document.title = problems.length ? "FAILED: " + problems.join("; ") : "PASSED";
</script>
END
awk -v head="$scratch/head.html" -v visitor="$scratch/visitor.html" '
    function put(file,   line) { while ((getline line < file) > 0) print line; close(file) }
    /^<\/body>$/ { put(visitor) }
    { print }
    /^<meta charset/ { put(head) }' "$scratch/out/index.html" > "$scratch/page.html"

# Root, as in containers, has no sandbox; nothing of the browser may ask the network.
sandbox=()
[[ $(id -u) -ne 0 ]] || sandbox=(--no-sandbox)
timeout 120 "$chromium" --headless "${sandbox[@]}" --disable-gpu --disable-quic --no-first-run \
    --disable-background-networking --disable-component-update --disable-sync \
    --user-data-dir="$scratch/profile" --window-size=1280,1000 --virtual-time-budget=10000 \
    --dump-dom "file://$scratch/page.html" > "$scratch/dom.html" 2> "$scratch/log" || {
    tail -20 "$scratch/log"
    echo "$0: Chromium failed" >&2
    exit 1
}
title=$(grep -o '<title>[^<]*' "$scratch/dom.html" | head -1 | cut -c8-)
echo "$title"
[[ $title == PASSED ]]
