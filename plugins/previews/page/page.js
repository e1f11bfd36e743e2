// SPDX-License-Identifier: Apache-2.0
// Asks the render for its state and shows it. The picture arrives linear, so that exposure changes
// without asking again.
"use strict";
const element = (id) => document.getElementById(id);
const pause = 500;  // [ms]
let picture = null, pictureNumber = 0, exposureChosen = false, ended = false;

// The sRGB curve for linear values (i / 4096)², which leaves steps in the dark finer than a byte.
const srgbTable = Uint8ClampedArray.from({length: 4097}, (_, i) => {
    const x = (i / 4096) ** 2;
    return 255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * x ** (1 / 2.4) - 0.055);
});

function paint() {
    const exposure = Number(element("exposure").value), factor = 2 ** exposure;
    element("exposure-value").textContent = `${exposure > 0 ? "+" : ""}${exposure} EV`;
    if (!picture) return;
    const canvas = element("picture"), {width, height, values} = picture;
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, {width, height});
    const pixels = new ImageData(width, height), bytes = pixels.data;
    for (let i = 0; i < width * height; ++i) {
        for (let c = 0; c < 3; ++c) {
            const x = Math.min(Math.max(values[3 * i + c] * factor, 0), 1) || 0;
            bytes[4 * i + c] = srgbTable[Math.round(4096 * Math.sqrt(x))];
        }
        bytes[4 * i + 3] = 255;
    }
    canvas.getContext("2d").putImageData(pixels, 0, 0);
}

async function fetchPicture() {
    const bytes = await (await fetch("picture")).arrayBuffer();
    const [width, height] = new Uint32Array(bytes, 0, 2);
    picture = {width, height, values: new Float32Array(bytes, 8)};
    paint();
}

function duration(seconds) {
    if (seconds === null || seconds > 1e9) return "–";
    const s = Math.round(seconds), two = (x) => String(x).padStart(2, "0");
    const hours = Math.floor(s / 3600), minutes = Math.floor(s / 60) % 60;
    return hours ? `${hours}:${two(minutes)}:${two(s % 60)}` : `${minutes}:${two(s % 60)}`;
}

const number = (x) => (x === null ? "–" : Number(x.toPrecision(3)).toString());

function showProgress(progress) {
    element("fraction").value = progress.fraction;
    element("left").textContent = duration(progress.seconds_left);
    element("seconds").textContent = duration(progress.seconds);
    element("samples").textContent = progress.samples_per_pixel;
    element("rays").textContent = `${number(progress.rays_per_second * 1e-6)} M/s`;
    element("error").textContent = number(progress.relative_mse);
    const [low, high] = [progress.relative_mse_low, progress.relative_mse_high];
    element("interval").textContent = low === null ? "–" : `${number(low)} to ${number(high)}`;
}

// The figures of the finished render, in place of the last progress.
function showFigures(figures, text) {
    const error = figures.error ?? {relative_mse: null, relative_mse_low: null, relative_mse_high: null};
    showProgress({fraction: element("fraction").value, seconds_left: 0, seconds: figures.render_seconds,
                  samples_per_pixel: figures.samples_per_pixel,
                  rays_per_second: figures.rays_per_second, ...error});
    element("figures").textContent = text;
    element("figures").hidden = false;
}

// Both axes are logarithmic: the error of an unbiased render falls along a straight line.
function drawErrors(errors) {
    const svg = element("errors"), points = errors.filter(([t, e]) => t > 0 && e > 0);
    if (!points.length) return;
    const add = (name, attributes, text = "") => {
        const node = document.createElementNS("http://www.w3.org/2000/svg", name);
        for (const [key, value] of Object.entries(attributes)) node.setAttribute(key, value);
        node.textContent = text;
        svg.append(node);
    };
    const decades = (values) => {
        const logs = values.map(Math.log10);
        const low = Math.floor(Math.min(...logs));
        return [low, Math.max(Math.ceil(Math.max(...logs)), low + 1)];
    };
    const [t0, t1] = decades(points.map((p) => p[0])), [e0, e1] = decades(points.map((p) => p[1]));
    const x = (log) => 50 + 260 * (log - t0) / (t1 - t0), y = (log) => 175 - 165 * (log - e0) / (e1 - e0);
    svg.replaceChildren();
    for (let d = t0; d <= t1; ++d) {
        add("line", {x1: x(d), x2: x(d), y1: 10, y2: 175});
        add("text", {x: x(d), y: 192, "text-anchor": "middle"}, `${Number((10 ** d).toPrecision(1))} s`);
    }
    for (let d = e0; d <= e1; ++d) {
        add("line", {x1: 50, x2: 310, y1: y(d), y2: y(d)});
        add("text", {x: 45, y: y(d) + 4, "text-anchor": "end"}, (10 ** d).toExponential(0));
    }
    const places = points.map(([t, e]) => [x(Math.log10(t)), y(Math.log10(e))]);
    add("polyline", {points: places.map((p) => p.join()).join(" ")});
    const [cx, cy] = places.at(-1);
    add("circle", {cx, cy, r: 3});
}

async function update() {
    const status = await (await fetch("status")).json();
    if (!exposureChosen) element("exposure").value = status.exposure;
    element("name").textContent = status.name;
    element("state").textContent = status.state;
    document.title = `${status.state}: ${status.name}`;
    if (status.progress) showProgress(status.progress);
    drawErrors(status.errors);
    ended = status.state === "finished";
    element("stop").disabled = status.state !== "rendering";
    if (status.picture !== pictureNumber) {
        pictureNumber = status.picture;
        await fetchPicture();
    }
    if (ended) showFigures(status.figures, status.figures_text);
}

async function watch() {
    while (!ended) {
        try {
            await update();
        } catch {
            element("state").textContent = "the render has ended, or cannot be reached";
            element("stop").disabled = true;
        }
        await new Promise((resolve) => setTimeout(resolve, pause));
    }
}

element("exposure").addEventListener("input", () => {
    exposureChosen = true;
    paint();
});
element("stop").addEventListener("click", async () => {
    element("stop").disabled = true;
    await fetch("stop", {method: "POST"});
});
watch();
