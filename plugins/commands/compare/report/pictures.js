// SPDX-License-Identifier: Apache-2.0
// The data of the page, and what is painted from them. Pictures are linear halves; a display value is
// computed here, so exposure and pixel values are those of the render.

const report = JSON.parse(document.getElementById("report").textContent);
const {width, height} = report;
const palette = ["#2a78d6", "#e8652b", "#17a673", "#d99a00", "#7a5bd0", "#d8433f", "#d968a0", "#4c8c1f",
                 "#7d7a72"];
const colorOf = (number) => palette[(number - 1) % palette.length];

// Number 0 is the reference; the variants follow.
const pictures = ["reference", ...report.variants.map((variant) => variant.name)].map(
    (name, number) => ({name, number, values: decodePicture("picture-" + number)}));

function halfToFloat(bits) {
    const exponent = (bits >> 10) & 31, mantissa = bits & 1023;
    const magnitude = exponent === 0 ? mantissa * 2 ** -24 : (1024 + mantissa) * 2 ** (exponent - 25);
    return bits & 0x8000 ? -magnitude : magnitude;
}

function decodePicture(id) {
    const bytes = atob(document.getElementById(id).textContent);
    const values = new Float32Array(bytes.length / 2);
    for (let i = 0; i < values.length; ++i) {
        values[i] = halfToFloat(bytes.charCodeAt(2 * i) | (bytes.charCodeAt(2 * i + 1) << 8));
    }
    return values;
}

function srgbByte(linear) {
    const v = Math.min(Math.max(linear, 0), 1);
    return 255 * (v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055) + 0.5;
}

// The sRGB curve as a table: a power for each value would be slow.
const srgbTable = Uint8ClampedArray.from({length: 4097}, (_, i) => Math.floor(srgbByte((i / 4096) ** 2)));

function relativeError(values, i) {
    const reference = pictures[0].values;
    let sum = 0;
    for (let c = 3 * i; c < 3 * i + 3; ++c) {
        const difference = values[c] - reference[c];
        sum += difference * difference / (reference[c] * reference[c] + report.epsilon);
    }
    return sum / 3;
}

for (const picture of pictures) {
    picture.errors = new Float32Array(width * height);
    for (let i = 0; i < width * height; ++i) picture.errors[i] = relativeError(picture.values, i);
}

// One scale for all error maps: four decades below the error that only 0.1 % of the pixels exceed.
const scaleTop = (() => {
    let top = 0;
    for (const picture of pictures.slice(1)) {
        const sorted = Float32Array.from(picture.errors).sort();
        top = Math.max(top, sorted[Math.floor(0.999 * (sorted.length - 1))]);
    }
    return 10 ** Math.ceil(Math.log10(top || 1));
})();
const scaleDecades = 4;

// Colours on the way through "magma" of matplotlib.
const magma = [[0, 0, 4], [28, 16, 68], [79, 18, 123], [129, 37, 129], [181, 54, 122], [229, 80, 100],
               [251, 135, 97], [254, 194, 135], [252, 253, 191]];

function magmaColor(t) {
    const x = Math.min(Math.max(t, 0), 1) * (magma.length - 1);
    const i = Math.min(Math.floor(x), magma.length - 2), f = x - i;
    return magma[i].map((v, c) => v + f * (magma[i + 1][c] - v));
}

const magmaTable = Array.from({length: 256}, (_, i) => magmaColor(i / 255));

function blankCanvas(w, h) {
    const canvas = document.createElement("canvas");
    canvas.width = w;
    canvas.height = h;
    return canvas;
}

function paint(fill) {
    const canvas = blankCanvas(width, height), context = canvas.getContext("2d");
    const data = context.createImageData(width, height);
    data.data.fill(255);
    for (let i = 0; i < width * height; ++i) fill(data.data, i);
    context.putImageData(data, 0, 0);
    return canvas;
}

function paintPicture(picture, exposure) {
    const factor = 2 ** exposure;
    return paint((bytes, i) => {
        for (let c = 0; c < 3; ++c) {
            const v = Math.min(Math.max(picture.values[3 * i + c] * factor, 0), 1);
            bytes[4 * i + c] = srgbTable[Math.round(4096 * Math.sqrt(v))];
        }
    });
}

function paintErrors(picture) {
    return paint((bytes, i) => {
        const t = 1 + Math.log10(picture.errors[i] / scaleTop) / scaleDecades;
        const color = magmaTable[Math.min(Math.max(Math.round(255 * t), 0), 255) || 0];
        for (let c = 0; c < 3; ++c) bytes[4 * i + c] = color[c];
    });
}

function powerOfTen(exponent) {
    const digits = {"-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹"};
    return "10" + [...String(exponent)].map((c) => digits[c]).join("");
}

function fillScale(element) {
    const canvas = blankCanvas(256, 1), context = canvas.getContext("2d");
    magmaTable.forEach((color, i) => {
        context.fillStyle = `rgb(${color.map(Math.round)})`;
        context.fillRect(i, 0, 1, 1);
    });
    const top = Math.round(Math.log10(scaleTop));
    element.append("relative squared error  ≤ " + powerOfTen(top - scaleDecades), canvas,
                   "≥ " + powerOfTen(top));
}
