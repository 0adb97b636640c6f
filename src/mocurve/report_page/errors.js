// -- errors of joints ----------------------------------------------------------------------------------------------------
function showJoints() {
  const rows = data.joints.map((joint) => ({ name: joint.name, tolerance: joint.tolerance, max: length(joint.max), rms: length(joint.rms) })).sort((x, y) => y.max - x.max);
  const place = rows.map((_, i) => i), names = rows.map((row) => literal(row.name));
  const high = Math.max(220, 70 + 19 * rows.length);
  const bar = (part, name, color, width) => ({ type: "bar", orientation: "h", y: place, x: rows.map((row) => row[part]), customdata: names, name, marker: { color }, width, hovertemplate: `%{customdata}: %{x:.3g} ${LENGTH}` });
  const limits = rows.map((row) => (row.tolerance === null ? null : length(row.tolerance)));
  const marks = { type: "scatter", mode: "markers", x: limits, y: place, name: "tolerance", marker: { symbol: "line-ns", size: 13, line: { color: RED, width: 2 } }, hovertemplate: `tolerance %{x:.3g} ${LENGTH}` };
  const bars = [bar("max", "largest", "#a9c3de", 0.78), bar("rms", "RMS", BLUE, 0.34)];
  $("joint-plot").style.height = `${high}px`;
  Plotly.newPlot("joint-plot", limits.some((x) => x !== null) ? [...bars, marks] : bars, layout({
    barmode: "overlay", hovermode: "closest", margin: { l: 64, r: 20, t: 40, b: 44 }, legend: { orientation: "h", x: 1, xanchor: "right", y: 1, yanchor: "bottom", traceorder: "normal" },
    xaxis: { title: { text: mm === null ? "file units" : "millimetres" }, rangemode: "tozero" },
    yaxis: { tickvals: place, ticktext: names, range: [rows.length - 0.4, -0.6], tickfont: { size: 12 }, fixedrange: true },
  }), CONFIG);
  if (cleaning) $("joints-title").textContent = "Change of each joint";
  const worst = rows.length ? `${rows[0].name} ${cleaning ? "was moved furthest" : "is furthest off"}, ${three(rows[0].max)} ${LENGTH}` : "";
  $("joints-hint").textContent = `Distance in space between the two clips, joints and end sites, all frames, the furthest first. ${worst}.`;
}

// -- keys against tolerance, error against ratio (Önder 2007, figures 4.5 and 4.7) ---------------------------------------
function showSweep() {
  if (!data.sweep) return;
  $("sweep").hidden = false;
  $("sweep-hint").textContent = data.sweep.words;
  const colours = { optimal: BLUE, "optimal, held in space": GREEN, split: ORANGE, "split by ratio": RED };
  const traces = (x, y) => data.sweep.lines.filter((line) => line[x] !== null).map((line) => ({
    x: line[x], y: line[y], text: line.labels, name: literal(line.name), mode: "lines+markers", line: { color: colours[line.name], width: 2 }, marker: { size: 7 },
    hovertemplate: "%{text}: %{x:.3g}, %{y:.3g}",
  }));
  const here = { x: [data.sweep.here.percent], y: [length(data.sweep.here.world)], text: ["this clip"], name: "this page", mode: "markers", marker: { symbol: "star", size: 15, color: INK, line: { color: "#fff", width: 1 } }, hovertemplate: "these keys: %{x:.3g} %, %{y:.3g}" };
  const log = (title) => ({ title: { text: title }, type: "log", dtick: "D2" });
  const margin = { l: 64, r: 14, t: 66, b: 48 }, legend = { orientation: "h", x: 0, y: 1.01, yanchor: "bottom" };
  const least = { x: data.sweep.bound.tolerance, y: data.sweep.bound.keys, mode: "lines", name: "proven least", line: { color: GREY, width: 2, dash: "dot" }, hovertemplate: "at least %{y:.3g}" };
  Plotly.newPlot("keys-plot", [...traces("tolerance", "keys"), least], layout({ margin, legend, xaxis: log("tolerance, degrees"), yaxis: log("keys a channel, on the average"), hovermode: "closest" }), CONFIG);
  const space = traces("percent", "world");
  for (const trace of space) trace.y = trace.y.map(length);
  Plotly.newPlot("ratio-plot", data.keyed ? [...space, here] : space, layout({ margin, legend, xaxis: log("keys left, % of the samples"), yaxis: log(`largest error in space, ${LENGTH}`), hovermode: "closest" }), CONFIG);
}

showNumbers();
startNoise();
startCurves();
startFigures();
showJoints();
showSweep();
