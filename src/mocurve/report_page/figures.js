// -- two figures in space ----------------------------------------------------------------------------------------------
const poses = data.poses, a = floats(poses.a), b = floats(poses.b), J = data.joints.length;
const bones = data.joints.map((joint, j) => [joint.parent, j]).filter(([parent]) => parent >= 0);
let playing = null, frame = 0;

function centre(n) {  // where the floor under the figure is drawn: under the original's root, or at the middle of the clip
  return $("follow").checked ? [poses.way[2 * n], poses.way[2 * n + 1]] : poses.middle;
}

function camera() { return $("figures").layout?.scene?.camera || CAMERA; }

function behind() {  // a little away from the viewer, so that the original does not flicker through what lies on it
  const { eye } = camera(), far = Math.hypot(eye.x, eye.y, eye.z), step = -0.012 * (poses.top - poses.floor) / far;
  return [step * eye.x, step * eye.y, step * eye.z];
}

function figure(places, n, by = [0, 0, 0]) {  // (x, y up, z) -> Plotly's (x, -z, y): upright, seen from the front
  const [cx, cz] = centre(n), bone = { x: [], y: [], z: [] }, joint = { x: [], y: [], z: [] };
  const at = (j) => { const i = 3 * (n * J + j); return [places[i] - cx + by[0], cz - places[i + 2] + by[1], places[i + 1] + by[2]]; };
  const put = (target, p) => { target.x.push(p[0]); target.y.push(p[1]); target.z.push(p[2]); };
  for (const [from, to] of bones) { put(bone, at(from)); put(bone, at(to)); put(bone, [null, null, null]); }
  for (let j = 0; j < J; j++) put(joint, at(j));
  return { bone, joint };
}

function floor(n) {
  const [cx, cz] = centre(n), s = poses.square, half = box(), lines = { x: [], y: [], z: [] };
  const put = (x, y) => { lines.x.push(x); lines.y.push(y); lines.z.push(x === null ? null : poses.floor); };
  for (let x = Math.ceil((cx - half[0]) / s) * s; x <= cx + half[0]; x += s) { put(x - cx, -half[1]); put(x - cx, half[1]); put(null, null); }
  for (let z = Math.ceil((cz - half[1]) / s) * s; z <= cz + half[1]; z += s) { put(-half[0], cz - z); put(half[0], cz - z); put(null, null); }
  return lines;
}

function box() { return $("follow").checked ? poses.near : poses.whole; }  // half extents along X and Z, length units

function jointErrors(n) {
  return Array.from({ length: J }, (_, j) => {
    const i = 3 * (n * J + j);
    return length(Math.hypot(a[i] - b[i], a[i + 1] - b[i + 1], a[i + 2] - b[i + 2]));
  });
}

function figureTraces(n) {
  const first = figure(a, n), ghost = figure(a, n, behind()), second = figure(b, n), off = jointErrors(n), ground = floor(n);
  const names = data.joints.map((joint) => literal(joint.name));
  const line = (place, scene, color, width) => ({ type: "scatter3d", mode: "lines", ...place, scene, line: { color, width }, hoverinfo: "skip", showlegend: false });
  return [
    line(ground, "scene", "#d3dae2", 1.5), line(ground, "scene2", "#d3dae2", 1.5),
    line(first.bone, "scene", BLUE, 7), line(ghost.bone, "scene2", "#e3b7b0", 9), line(second.bone, "scene2", GREEN, 6),
    { type: "scatter3d", mode: "markers", ...first.joint, scene: "scene", text: names, hovertemplate: "%{text}<extra></extra>", marker: { size: 3.2, color: BLUE }, showlegend: false },
    { type: "scatter3d", mode: "markers", ...second.joint, scene: "scene2", text: names, customdata: off, hovertemplate: `%{text}: %{customdata:.3g} ${LENGTH} off<extra></extra>`, marker: { size: 3.6, color: off, cmin: 0, cmax: Math.max(length(data.report.max_error_world), 1e-9), colorscale: [[0, GREEN], [0.5, ORANGE], [1, RED]], showscale: true, colorbar: { orientation: "h", title: { text: `${cleaning ? "change" : "error"} of the joints, ${LENGTH}`, side: "top", font: { size: 12 } }, thickness: 8, len: 0.4, x: 0.753, xanchor: "center", y: 0, yanchor: "top", ypad: 4, tickfont: { size: 11 }, outlinewidth: 0 } }, showlegend: false },
  ];
}

function sceneLayout(domain, view) {
  const [x, z] = box(), high = poses.top - poses.floor, largest = Math.max(1.24 * x, 1.24 * z, high), axis = { visible: false, showspikes: false };
  const part = (extent) => 1.35 * extent / largest;
  return {
    domain, camera: view, aspectmode: "manual", aspectratio: { x: part(2 * x), y: part(2 * z), z: part(high) }, dragmode: "orbit", bgcolor: "#fafbfc",
    xaxis: { ...axis, range: [-x, x] }, yaxis: { ...axis, range: [-z, z] }, zaxis: { ...axis, range: [poses.floor - 1e-3 * high, poses.top] },
  };
}

const CAMERA = { eye: { x: 1.15, y: -1.7, z: 0.5 }, center: { x: 0, y: 0, z: -0.03 }, up: { x: 0, y: 0, z: 1 } };

function drawFigures() {
  const label = (text, x) => ({ text, x, y: 1.0, xref: "paper", yref: "paper", yanchor: "bottom", showarrow: false, font: { size: 14 } });
  const titles = data.keyed ? [noise ? "clean" : "original", "from the keys"] : cleaning ? ["captured", "clean"] : ["first clip", "second clip"];
  return Plotly.react("figures", figureTraces(frame), layout({
    margin: { l: 0, r: 0, t: 26, b: 46 }, annotations: [label(titles[0], 0.247), label(titles[1], 0.753)],
    scene: sceneLayout({ x: [0, 0.495], y: [0, 1] }, camera()), scene2: sceneLayout({ x: [0.505, 1], y: [0, 1] }, camera()),
  }), { ...CONFIG, displayModeBar: false, scrollZoom: true });
}

function moveFigures() {
  const traces = figureTraces(frame), all = (part) => traces.map((trace) => trace[part]);
  const colours = traces.map((trace) => (trace.customdata ? trace.customdata : trace.marker ? trace.marker.color : undefined));
  Plotly.restyle("figures", { x: all("x"), y: all("y"), z: all("z"), customdata: all("customdata"), "marker.color": colours });
}

function show(n) {
  frame = n;
  $("frame").value = String(n);
  const seconds = n / poses.fps;
  $("time").textContent = `${seconds.toFixed(2)} / ${data.duration.toFixed(2)} s`;
  moveFigures();
}

function seek(seconds) { show(Math.max(0, Math.min(poses.count - 1, Math.round(seconds * poses.fps)))); }

function play() {
  if (playing !== null) { pause(); return; }
  $("play").textContent = "Pause";
  let last = performance.now(), at = frame >= poses.count - 1 ? 0 : frame;
  const step = (now) => {
    at = (at + Math.max(0, now - last) / 1000 * poses.fps * Number($("speed").value)) % Math.max(poses.count, 1);
    last = now;
    if (Math.floor(at) !== frame) show(Math.floor(at));
    playing = requestAnimationFrame(step);
  };
  playing = requestAnimationFrame(step);
}

function pause() {
  cancelAnimationFrame(playing);
  playing = null;
  $("play").textContent = "Play";
}

function startFigures() {
  if (!poses.count) {
    $("space").hidden = true;
    return;
  }
  $("frame").max = String(poses.count - 1);
  $("follow").checked = poses.travels;
  drawFigures();
  show(0);
  $("play").addEventListener("click", play);
  $("frame").addEventListener("input", () => { if (playing !== null) pause(); show(Number($("frame").value)); });
  $("follow").addEventListener("change", drawFigures);
  let turning = false;
  const together = (event) => {  // turning one view turns the other
    const turned = event["scene.camera"] || event["scene2.camera"];
    if (!turned || turning) return;
    turning = true;
    const other = event["scene.camera"] ? "scene2.camera" : "scene.camera";
    Plotly.relayout("figures", { [other]: turned }).then(() => { turning = false; moveFigures(); });
  };
  $("figures").on("plotly_relayouting", together);
  $("figures").on("plotly_relayout", together);
}
