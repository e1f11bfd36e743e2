// SPDX-License-Identifier: Apache-2.0
// The words, the chart and the table.

const element = (id) => document.getElementById(id);

function create(tag, text = "", attributes = {}) {
    const result = document.createElement(tag);
    result.textContent = text;
    for (const [name, value] of Object.entries(attributes)) result.setAttribute(name, value);
    return result;
}

const ink = (name) => getComputedStyle(document.documentElement).getPropertyValue("--" + name).trim();
const missing = (x) => x === null || x === undefined;

function number(x, digits = 3) {
    if (missing(x)) return "–";
    if (x !== 0 && (Math.abs(x) < 1e-3 || Math.abs(x) >= 1e5)) return x.toExponential(digits - 1);
    return Number(x.toPrecision(digits)).toString();
}

function seconds(x) {
    return x < 0.0995 ? number(1000 * x, 2) + " ms" : number(x, 3) + " s";
}

function large(x) {
    const units = [[1e12, "T"], [1e9, "G"], [1e6, "M"], [1e3, "k"]];
    const unit = units.find(([size]) => x >= size);
    return unit ? number(x / unit[0], 3) + " " + unit[1] : number(x, 3);
}

function factor(interval) {
    if (missing(interval.value)) return "–";
    return "×" + number(interval.value, interval.value < 10 ? 3 : 4);
}

const brackets = (i) => missing(i.low) ? "" : `[${number(i.low)}, ${number(i.high)}]`;

function budgetText() {
    const {seconds: time, samples_per_pixel: samples, relative_mse: error} = report.budget;
    if (!missing(time)) return `${number(time)} s for each run`;
    if (!missing(samples)) return `${samples} samples per pixel`;
    return `until relMSE ${number(error)}`;
}

// The most efficient variant, and whether its interval leaves the others behind.
function verdict() {
    const unbiased = report.variants.filter((v) => !v.bias.biased && !missing(v.efficiency.value));
    const biased = report.variants.filter((v) => v.bias.biased).map((v) => v.name).join(", ");
    const tail = biased && ` Biased, and so not in the running: ${biased}.`;
    if (unbiased.length === 0) return "Every variant differs from the reference: none can be recommended." + tail;
    const best = unbiased.reduce((a, b) => b.efficiency.value > a.efficiency.value ? b : a);
    const first = report.variants[0];
    const rest = unbiased.filter((v) => v !== first);
    if (best === first || best.efficiency.low <= 1) {
        const near = rest.filter((v) => v.efficiency.high >= 1).map((v) => v.name).join(", ");
        if (!rest.length || !near) return `${first.name} is the most efficient.` + tail;
        return `Nothing is surely more efficient than ${first.name}; as good, as far as these runs can ` +
               `tell: ${near}.` + tail;
    }
    return `${best.name} has ${factor(best.efficiency)} ${brackets(best.efficiency)} the efficiency of ` +
           `${first.name}.` + tail;
}

function writeHeader() {
    const scene = report.scene.split("/");
    const file = scene.pop();
    element("title").textContent = file === "scene.xml" && scene.length ? scene.pop() : file;
    document.title = element("title").textContent + " · Lucerna comparison";
    element("verdict").textContent = verdict();
    element("facts").textContent =
        [budgetText(), report.repeats + " repeats", `${width} × ${height} pixels`,
         report.machine.threads + " threads", report.machine.processor,
         report.date.replace("T", " ").replace("Z", " UTC")].join(" · ");
    for (const text of report.warnings) element("warnings").append(create("li", text));
    element("warnings").hidden = report.warnings.length === 0;
}

// The runs' errors at a common place, between their measurements: geometric mean, and the interval of
// the median as in statistics.h.
function interpolate(points, x) {
    if (points.length === 1) return points[0][1];
    const next = points.findIndex((p) => p[0] >= x);
    const i = next < 0 ? points.length - 1 : Math.max(next, 1);
    const [a, b] = [points[i - 1], points[i]];
    const t = b[0] > a[0] ? (x - a[0]) / (b[0] - a[0]) : 0;
    return a[1] + Math.min(Math.max(t, 0), 1) * (b[1] - a[1]);
}

function aggregate(variant, metric, axis) {
    const runs = variant.runs.map((run) => run.curve
        .filter((p) => p[axis] > 0 && p[metric] > 0)
        .map((p) => [Math.log(p[axis]), Math.log(p[metric])])).filter((run) => run.length > 0);
    if (runs.length === 0) return {line: [], dots: []};
    const begin = Math.max(...runs.map((run) => run[0][0]));
    const end = Math.max(begin, Math.min(...runs.map((run) => run[run.length - 1][0])));
    const steps = end > begin ? 48 : 0;
    const line = Array.from({length: steps + 1}, (_, k) => {
        const x = begin + (steps ? k / steps : 0) * (end - begin);
        const logs = runs.map((run) => interpolate(run, x));
        const mean = logs.reduce((a, b) => a + b, 0) / logs.length;
        const squares = logs.reduce((a, b) => a + (b - mean) ** 2, 0);
        const margin = logs.length < 2 ? 0 :
            report.student_t * Math.sqrt(squares / (logs.length - 1) / logs.length);
        logs.sort((a, b) => a - b);
        const rank = Math.min(report.median_rank, logs.length);
        return {x: Math.exp(x), y: Math.exp(mean),
                low: Math.exp(Math.min(mean - margin, logs[rank - 1])),
                high: Math.exp(Math.max(mean + margin, logs[logs.length - rank]))};
    });
    return {line, dots: runs.flat().map(([x, y]) => ({x: Math.exp(x), y: Math.exp(y)}))};
}

const hiddenVariants = new Set();

function datasets(metric, axis) {
    const sets = [];
    report.variants.forEach((variant, index) => {
        const color = colorOf(index + 1), hidden = hiddenVariants.has(index);
        const {line, dots} = aggregate(variant, metric, axis);
        const common = {variant: index, hidden, pointRadius: 0, borderColor: color};
        sets.push({...common, data: line, borderWidth: 2.5, label: variant.name, order: 1,
                   pointRadius: line.length === 1 ? 5 : 0, pointBackgroundColor: color, pointHitRadius: 6});
        sets.push({...common, data: line.map(({x, high}) => ({x, y: high})), borderWidth: 0, fill: "+1",
                   backgroundColor: color + "2e", order: 3});
        sets.push({...common, data: line.map(({x, low}) => ({x, y: low})), borderWidth: 0, order: 3});
        sets.push({...common, data: dots, showLine: false, pointRadius: 1.8, order: 2,
                   pointBackgroundColor: color + "80", pointBorderWidth: 0});
    });
    const start = sets.find((set) => set.label && set.data.length > 1);
    if (start) sets.push({...guide(start.data), order: 4});
    return sets;
}

function guide(line) {
    const a = line[0], b = line[line.length - 1];
    return {data: [{x: a.x, y: a.y * 1.6}, {x: b.x, y: a.y * 1.6 * a.x / b.x}], borderColor: ink("soft"),
            borderWidth: 1, borderDash: [5, 5], pointRadius: 0};
}

// Whole decades in figures, others without; a short axis gets twos and fives as well.
function tick(value, index, ticks) {
    const exponent = Math.log10(value), whole = Math.abs(exponent - Math.round(exponent)) < 1e-6;
    const decades = Math.log10(ticks[ticks.length - 1].value / ticks[0].value);
    const digit = Math.round(value / 10 ** Math.floor(exponent + 1e-9));
    if (!whole && !(decades < 2.2 && (digit === 2 || digit === 5))) return "";
    return Math.abs(exponent) < 3.5 ? number(value, 2) : whole ? powerOfTen(Math.round(exponent)) : "";
}

function scale(title) {
    return {type: "logarithmic", title: {display: true, text: title, color: ink("soft")},
            grid: {color: ink("line"), borderColor: ink("line")},
            ticks: {color: ink("soft"), callback: tick, maxRotation: 0, autoSkip: false}};
}

const selected = (id) => element(id).selectedOptions[0];

function drawChart(chart) {
    const metric = selected("curve-metric"), axis = selected("curve-axis");
    const unit = axis.value === "samples_per_pixel" ? "" : " [s]";
    chart.data.datasets = datasets(metric.value, axis.value);
    chart.options.scales = {x: scale(axis.textContent + unit), y: scale(metric.textContent)};
    chart.update();
}

function makeChart() {
    const chart = new Chart(element("chart"), {
        type: "line",
        data: {datasets: []},
        options: {
            animation: false, maintainAspectRatio: false, parsing: false,
            interaction: {mode: "nearest", intersect: false},
            plugins: {
                legend: {display: false},
                tooltip: {
                    filter: (item) => Boolean(item.dataset.label),
                    callbacks: {
                        title: ([item]) => item ? number(item.raw.x) : "",
                        label: ({dataset, raw}) =>
                            `${dataset.label}: ${number(raw.y)} [${number(raw.low)}, ${number(raw.high)}]`,
                    },
                },
            },
        },
    });
    for (const id of ["curve-metric", "curve-axis"]) {
        element(id).addEventListener("change", () => drawChart(chart));
    }
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => drawChart(chart));
    report.variants.forEach((variant, index) => {
        const button = create("button", "", {"aria-pressed": "true"});
        button.append(swatch(index + 1), variant.name);
        button.addEventListener("click", () => {
            hiddenVariants.has(index) ? hiddenVariants.delete(index) : hiddenVariants.add(index);
            button.setAttribute("aria-pressed", String(!hiddenVariants.has(index)));
            drawChart(chart);
        });
        element("legend").append(button);
    });
    drawChart(chart);
}

function swatch(number) {
    return create("span", "", {class: "swatch", style: `background:${number ? colorOf(number) : "#fff0"}`});
}

// A whisker on a logarithmic axis that is the same in all rows; the tick is the first variant.
function whisker(interval, color) {
    const values = report.variants.flatMap((v) => [v.efficiency.low, v.efficiency.high])
        .filter((x) => x > 0 && isFinite(x));
    const low = Math.log(Math.min(0.8, ...values)), high = Math.log(Math.max(1.25, ...values));
    const place = (x) => 4 + 122 * (Math.log(x) - low) / (high - low);
    const {value, low: a, high: b} = interval;
    const holder = create("span");
    holder.innerHTML = `<svg width="130" height="12" aria-hidden="true"><path d="M${place(1)} 0V12"
        stroke="${ink("soft")}" stroke-dasharray="2 2"/><path d="M${place(a)} 6H${place(b)}" stroke="${color}"
        stroke-width="2"/><circle cx="${place(value)}" cy="6" r="3.5" fill="${color}"/></svg>`;
    return holder.firstChild;
}

function cell(main, ...details) {
    const td = create("td");
    td.append(create("b", main), ...details.map((text) => create("small", text)));
    return td;
}

function biasCell({bias}) {
    const td = create("td");
    td.append(create("span", bias.biased ? "biased" : "none found",
                     {class: "badge " + (bias.biased ? "bad" : "good")}));
    const percent = (x) => number(100 * x, 2) + " %";
    const margin = (bias.brightness.high - bias.brightness.low) / 2;
    td.append(create("small", `brightness ${percent(bias.brightness.value)} ± ${percent(margin)}`),
              create("small", bias.biased ? `locally ${percent(bias.local.value)} (${percent(bias.local.low)} to ${
                  percent(bias.local.high)})` : `locally less than ${percent(bias.local.high)}`));
    return td;
}

function shadowText(v) {
    if (!v.shadow_rays) return ["no shadow rays"];
    return [number(100 * v.shadow_rays / v.rays, 2) + " % shadow", number(100 * v.visible, 2) + " % of them free"];
}

function makeTable() {
    const table = element("table"), head = create("tr");
    for (const title of ["variant", "efficiency", "relMSE", "trimmed relMSE", "MSE", "ꟻLIP", "bias", "time",
                         "rays", "memory"]) head.append(create("th", title));
    table.append(head);
    const best = Math.max(...report.variants.map((v) => v.bias.biased ? 0 : v.efficiency.value));
    report.variants.forEach((v, index) => {
        const row = create("tr"), name = create("td");
        name.append(swatch(index + 1), v.name);
        const efficiency = cell(factor(v.efficiency), index ? brackets(v.efficiency) : "the measure");
        if (!missing(v.efficiency.value)) efficiency.append(whisker(v.efficiency, colorOf(index + 1)));
        if (v.efficiency.value === best) efficiency.className = "best";
        const worst = `worst 0.1 %: ${number(100 * v.trimmed_share, 2)} % of all`;
        row.append(name, efficiency, cell(number(v.relative_mse.value), brackets(v.relative_mse)),
                   cell(number(v.trimmed_relative_mse.value), worst),
                   cell(number(v.mse.value), brackets(v.mse)), cell(number(v.flip.value), brackets(v.flip)),
                   biasCell(v), cell(seconds(v.render_seconds), `+ ${seconds(v.build_seconds)} to build`),
                   cell(large(v.rays), ...shadowText(v), number(v.samples_per_pixel, 4) + " spp"),
                   cell(large(v.peak_memory_bytes) + "B",
                        ...(v.light_sampler_bytes ? [large(v.light_sampler_bytes) + "B sampler"] : [])));
        table.append(row);
    });
}

// Variances lie on one logarithmic axis for all kinds of points; the bound is the left end of each bar.
function varianceBar(value, bound, range, color) {
    const place = (x) => 4 + 192 * (Math.log(Math.max(x, range.low)) - Math.log(range.low)) /
        (Math.log(range.high) - Math.log(range.low));
    const holder = create("span");
    holder.innerHTML = `<svg width="200" height="12" aria-hidden="true"><path d="M${place(bound)} 6H${place(value)}"
        stroke="${color}" stroke-width="6" opacity="0.45"/><path d="M${place(bound)} 0V12" stroke="${ink("soft")}"
        stroke-dasharray="2 2"/><circle cx="${place(value)}" cy="6" r="3.5" fill="${color}"/></svg>`;
    return holder.firstChild;
}

function oracleRow(section, name, figures, color, range) {
    const row = create("tr"), first = create("td"), bar = create("td"), blind = create("td");
    if (color) first.append(create("span", "", {class: "swatch", style: `background:${color}`}));
    first.append(name);
    if (figures.draws > 1) first.append(create("small", `${large(figures.draws)} draws, figures for one`));
    bar.append(varianceBar(figures.mean, section.bound.mean, range, color || ink("soft")));
    if (figures.blind_points) {
        blind.append(create("span", "never drawn", {class: "badge bad"}),
                     create("small", `at ${figures.blind_points} points; ${number(100 * figures.lost, 2)} % of the light`));
    } else if (figures.name) {
        blind.append(create("span", "all drawn", {class: "badge good"}));
    }
    const distance = section.bound.mean > 0 ? "×" + number(figures.mean / section.bound.mean, 3) : "";
    row.append(first, cell(number(figures.mean)), bar, cell(distance), cell(number(figures.median)),
               cell(number(figures.upper)), cell(number(figures.largest)), blind);
    return row;
}

function makeOracle() {
    const {oracle} = report;
    if (!oracle) return;
    element("oracle").hidden = false;
    const means = oracle.sections.flatMap((s) => [s.bound, s.unoccluded, ...s.variants].map((f) => f.mean))
        .filter((x) => x > 0);
    const range = {low: 0.5 * Math.min(...means), high: 1.5 * Math.max(...means)};
    const table = element("oracle-table");
    for (const section of oracle.sections) {
        const head = create("tr");
        const title = `${section.points} points ${section.name}`;
        for (const text of [title, "mean", "from the bound", "times bound", "median", "90 %", "largest",
                            "lights that contribute"]) head.append(create("th", text));
        table.append(head, oracleRow(section, "the bound", section.bound, "", range),
                     oracleRow(section, "best without shadows", section.unoccluded, "", range));
        section.variants.forEach((v, i) => table.append(oracleRow(section, v.name, v, colorOf(i + 1), range)));
    }
    const tested = oracle.tested < oracle.lights ? ` About ${oracle.tested} lights were tested for shadows at each
        point, chosen by their light without shadows and weighted.` : "";
    element("oracle-effort").textContent = `${oracle.samples} samples on each of ${oracle.lights} lights.${tested}`;
}

function makeMachines() {
    if (!report.by_parts) return;
    element("machines").hidden = false;
    const table = element("machines-table"), head = create("tr");
    for (const text of ["round", "node", "speed", "other programs", "threads", "processor", "system"]) {
        head.append(create("th", text));
    }
    table.append(head);
    for (const r of report.rounds) {
        const row = create("tr");
        row.append(cell(String(r.round)), cell(r.node), cell("×" + number(r.relative_speed, 3)),
                   cell(number(100 * r.other_load, 2) + " %"), cell(`${r.threads} of ${r.cores} processors`),
                   create("td", r.processor), create("td", r.system));
        table.append(row);
    }
}

function writeProvenance() {
    const {reference} = report, list = element("provenance");
    const noise = reference.noise_known ? `its own relMSE ${number(reference.relative_mse.value)}` :
        "its own noise is not known";
    const samples = reference.samples_per_pixel ? `, ${reference.samples_per_pixel} samples per pixel` : "";
    const facts = {
        command: report.command, scene: report.scene,
        reference: `${reference.file}${samples}, ${noise}`,
        budget: `${budgetText()}, ${report.repeats} repeats in turn, seed ${report.seed}`,
        machine: `${report.machine.processor}, ${report.machine.threads} threads, ${report.machine.system}`,
        version: "Lucerna " + report.version, data: "report.json, results.csv beside this page",
    };
    for (const [name, text] of Object.entries(facts)) list.append(create("dt", name), create("dd", text));
}

writeHeader();
makeChart();
makeTable();
makeOracle();
makeMachines();
writeProvenance();
