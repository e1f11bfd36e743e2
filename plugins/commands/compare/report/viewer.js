// SPDX-License-Identifier: Apache-2.0
// Looking at pictures: flipping in place, splitting, zooming, exposure, pixel values.

const state = {shown: Math.min(1, pictures.length - 1), before: 0, left: 0, errors: false, split: false,
               divider: 0.5, exposure: 0, zoom: 1, x: 0, y: 0, pixel: null};
const stage = element("stage"), view = element("view");

// Painted once for each exposure.
function canvasOf(picture) {
    if (state.errors && picture.number > 0) return picture.errorCanvas ??= paintErrors(picture);
    if (picture.exposure !== state.exposure) {
        picture.canvas = paintPicture(picture, state.exposure);
        picture.exposure = state.exposure;
    }
    return picture.canvas;
}

function fit() {
    state.zoom = Math.min(stage.clientWidth / width, stage.clientHeight / height);
    state.x = (stage.clientWidth - width * state.zoom) / 2;
    state.y = (stage.clientHeight - height * state.zoom) / 2;
}

let scheduled = false;
function refresh() {
    if (scheduled) return;
    scheduled = true;
    requestAnimationFrame(() => { scheduled = false; draw(); });
}

function draw() {
    const ratio = devicePixelRatio || 1;
    const w = Math.round(stage.clientWidth * ratio), h = Math.round(stage.clientHeight * ratio);
    if (view.width !== w || view.height !== h) Object.assign(view, {width: w, height: h});
    const context = view.getContext("2d");
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, w, h);
    context.imageSmoothingEnabled = state.zoom < 1;
    const divider = state.divider * w;
    if (state.split) drawPart(context, ratio, pictures[state.left], 0, divider);
    drawPart(context, ratio, pictures[state.shown], state.split ? divider : 0, w);
    if (state.zoom >= 56) drawValues(context, ratio);
    writeControls();
}

function drawPart(context, ratio, picture, from, to) {
    context.save();
    context.beginPath();
    context.rect(from, 0, to - from, view.height);
    context.clip();
    context.drawImage(canvasOf(picture), state.x * ratio, state.y * ratio, width * state.zoom * ratio,
                      height * state.zoom * ratio);
    context.restore();
}

// The three numbers in each pixel, when pixels are large.
function drawValues(context, ratio) {
    const {zoom, x, y} = state, visible = (origin, size, limit) => [
        Math.max(0, Math.floor(-origin / zoom)), Math.min(limit, Math.ceil((size - origin) / zoom))];
    const [left, right] = visible(x, stage.clientWidth, width);
    const [top, bottom] = visible(y, stage.clientHeight, height);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    Object.assign(context, {font: "11px monospace", textAlign: "center", lineWidth: 3, strokeStyle: "#000"});
    for (let row = top; row < bottom; ++row) {
        for (let column = left; column < right; ++column) {
            const center = x + (column + 0.5) * zoom;
            const onLeft = state.split && center < state.divider * stage.clientWidth;
            const {values} = pictures[onLeft ? state.left : state.shown];
            ["#ff9a9a", "#9fe8a5", "#a9c7ff"].forEach((color, c) => {
                const text = number(values[3 * (row * width + column) + c], 3);
                const line = y + (row + 0.5) * zoom + 14 * c - 10;
                context.strokeText(text, center, line);
                context.fillStyle = color;
                context.fillText(text, center, line);
            });
        }
    }
}

function writeControls() {
    element("exposure").value = state.exposure;
    element("exposure-value").textContent = `${state.exposure > 0 ? "+" : ""}${state.exposure} EV`;
    element("zoom").textContent = `${number(100 * state.zoom, 3)} %`;
    element("error").setAttribute("aria-pressed", state.errors);
    element("split").setAttribute("aria-pressed", state.split);
    element("scale").hidden = !state.errors;
    for (const id of ["divider", "left-label", "left-tag"]) element(id).hidden = !state.split;
    element("divider").style.left = 100 * state.divider + "%";
    element("left").value = state.left;
    element("left-tag").textContent = pictures[state.left].name;
    element("right-tag").textContent = pictures[state.shown].name;
    [...element("tabs").children].forEach((tab, i) => tab.setAttribute("aria-selected", i === state.shown));
    writePixel();
}

function writePixel() {
    const table = element("pixel"), {pixel} = state;
    table.replaceChildren();
    const head = create("tr");
    const place = pixel ? `pixel ${pixel[0]}, ${pixel[1]}` : "point at a pixel";
    for (const text of [place, "red", "green", "blue", "relative squared error"]) head.append(create("th", text));
    table.append(head);
    for (const picture of pictures) {
        const row = create("tr", "", picture.number === state.shown ? {class: "shown"} : {});
        const name = create("td");
        name.append(swatch(picture.number), picture.name);
        row.append(name);
        const i = pixel ? pixel[1] * width + pixel[0] : 0;
        for (let c = 0; c < 3; ++c) row.append(create("td", pixel ? number(picture.values[3 * i + c], 4) : "–"));
        row.append(create("td", pixel && picture.number ? number(picture.errors[i], 3) : "–"));
        table.append(row);
    }
}

function show(index) {
    if (index < 0 || index >= pictures.length || index === state.shown) return;
    state.before = state.shown;
    state.shown = index;
    refresh();
}

function setExposure(value) {
    state.exposure = Math.min(Math.max(value, -8), 8);
    refresh();
}

function toggle(name) {
    state[name] = !state[name];
    refresh();
}

function zoomAt(x, y, amount) {
    const smallest = Math.min(0.25, stage.clientWidth / width / 2);
    const zoom = Math.min(Math.max(state.zoom * amount, smallest), 128);
    state.x = x - (x - state.x) * zoom / state.zoom;
    state.y = y - (y - state.y) * zoom / state.zoom;
    state.zoom = zoom;
    refresh();
}

function onKey(event) {
    if (event.ctrlKey || event.metaKey || event.altKey || event.target.matches("select, input")) return;
    const {key} = event, count = pictures.length;
    const actions = {
        e: () => toggle("errors"), s: () => toggle("split"), r: () => { fit(); refresh(); },
        "+": () => setExposure(state.exposure + 0.5), "=": () => setExposure(state.exposure + 0.5),
        "-": () => setExposure(state.exposure - 0.5),
        ArrowRight: () => show((state.shown + 1) % count),
        ArrowLeft: () => show((state.shown + count - 1) % count),
        " ": () => show(state.before),
    };
    if (key === " " && event.target.matches("button")) return;
    if (/^[0-9]$/.test(key)) show(Number(key));
    else if (actions[key]) actions[key]();
    else return;
    event.preventDefault();
}

function pointAt(event) {
    const box = stage.getBoundingClientRect();
    return [event.clientX - box.left, event.clientY - box.top];
}

let dragged = null;
stage.addEventListener("pointerdown", (event) => {
    dragged = event.target === element("divider") ? "divider" : "picture";
    stage.setPointerCapture(event.pointerId);
});
stage.addEventListener("pointermove", (event) => {
    const [x, y] = pointAt(event);
    if (dragged === "divider") state.divider = Math.min(Math.max(x / stage.clientWidth, 0), 1);
    if (dragged === "picture") { state.x += event.movementX; state.y += event.movementY; }
    const pixel = [Math.floor((x - state.x) / state.zoom), Math.floor((y - state.y) / state.zoom)];
    const inside = pixel[0] >= 0 && pixel[1] >= 0 && pixel[0] < width && pixel[1] < height;
    state.pixel = inside ? pixel : null;
    refresh();
});
for (const name of ["pointerup", "pointercancel"]) stage.addEventListener(name, () => { dragged = null; });
stage.addEventListener("wheel", (event) => {
    zoomAt(...pointAt(event), 2 ** (-event.deltaY / 240));
    event.preventDefault();
}, {passive: false});
new ResizeObserver(refresh).observe(stage);
document.addEventListener("keydown", onKey);
element("exposure").addEventListener("input", (event) => setExposure(Number(event.target.value)));
element("error").addEventListener("click", () => toggle("errors"));
element("split").addEventListener("click", () => toggle("split"));
element("fit").addEventListener("click", () => { fit(); refresh(); });
element("left").addEventListener("change", (event) => { state.left = Number(event.target.value); refresh(); });

for (const picture of pictures) {
    const tab = create("button", "", {role: "tab"});
    tab.append(swatch(picture.number), picture.name + " ");
    if (picture.number <= 9) tab.append(create("kbd", String(picture.number)));
    tab.addEventListener("click", () => show(picture.number));
    element("tabs").append(tab);
    element("left").append(create("option", picture.name, {value: picture.number}));
}
for (const picture of pictures.slice(1)) {
    const button = create("button"), error = report.variants[picture.number - 1].runs[0].measured_relative_mse;
    picture.errorCanvas = paintErrors(picture);
    const copy = blankCanvas(width, height);
    copy.getContext("2d").drawImage(picture.errorCanvas, 0, 0);
    button.append(copy, swatch(picture.number), `${picture.name}: relMSE ${number(error)}`);
    button.addEventListener("click", () => {
        state.errors = true;
        show(picture.number);
        refresh();
        stage.scrollIntoView({block: "center"});
    });
    element("maps").append(button);
}
fillScale(element("scale"));
fillScale(element("maps-scale"));
// Small pictures need no large stage.
stage.style.height = `${Math.min(0.7 * innerHeight, Math.max(280, stage.clientWidth * height / width))}px`;
fit();
draw();
