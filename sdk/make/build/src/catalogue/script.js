const { library, textures, findings, removed, browserPackage } = JSON.parse(document.getElementById("data").textContent);
const STEP = 200; // rows shown at a time
const RATE = 8000; // of sounds that are made in the page, Hz
const element = (id) => document.getElementById(id);

// What a texture is found and sorted by.
for (const texture of textures) {
  texture.repeatability ??= undefined; // JSON's null
  const { name, tags, license, author, errors, missed, findings } = texture;
  const words = [name, ...tags, license, author, ...errors.map(([model]) => model), ...missed.map(([gate]) => gate),
    ...findings.map(([code]) => code)];
  texture.words = words.join("\n").toLowerCase();
  texture.error = errors.length ? Math.min(...errors.map(([, error]) => error)) : undefined;
}

// The state is the address's fragment, so that a search can be kept and shared.
const fields = new URLSearchParams(location.hash.slice(1));
const state = {
  query: fields.get("q") ?? "",
  sort: ["error", "repeatability", "bytes", "license"].includes(fields.get("sort")) ? fields.get("sort") : "name",
  descending: fields.has("descending"),
  leftOut: fields.has("left-out"),
  shown: STEP,
};

function keepState() {
  const kept = new URLSearchParams();
  if (state.query) kept.set("q", state.query);
  if (state.sort !== "name") kept.set("sort", state.sort);
  if (state.descending) kept.set("descending", "1");
  if (state.leftOut) kept.set("left-out", "1");
  history.replaceState(null, "", `#${kept}`);
}

// Names are sorted already; what has no value comes last both ways.
function sorted(found) {
  const { sort, descending } = state;
  const sign = descending ? -1 : 1;
  if (sort === "name") return descending ? found.toReversed() : found;
  const is = (texture) => texture[sort] !== undefined && texture[sort] !== "";
  return found.toSorted((a, b) => {
    if (!is(a) || !is(b)) return is(b) - is(a);
    return sign * (a[sort] < b[sort] ? -1 : a[sort] > b[sort] ? 1 : 0);
  });
}

function found() {
  const words = state.query.toLowerCase().split(/\s+/).filter(Boolean);
  return textures.filter((t) => (!state.leftOut || t.missed.length) && words.every((word) => t.words.includes(word)));
}

function tag(name, attributes, ...children) {
  const made = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.append(...children);
  return made;
}

function spectrum(levels) {
  const [width, height] = [150, 36];
  const namespace = "http://www.w3.org/2000/svg";
  const svg = document.createElementNS(namespace, "svg");
  svg.setAttribute("width", width);
  svg.setAttribute("height", height);
  svg.setAttribute("role", "img");
  svg.setAttribute("aria-label", "recorded spectrum");
  const at = (level, i) => `${((i / (levels.length - 1)) * width).toFixed(1)} ${(height - 1 - (level / 63) * (height - 2)).toFixed(1)}`;
  const path = document.createElementNS(namespace, "path");
  path.setAttribute("d", `M0 ${height} L${levels.map(at).join(" L")} L${width} ${height} Z`);
  svg.append(path);
  return svg;
}

function row(texture) {
  const { name, tags, errors, repeatability, bytes, license, missed, levels, findings } = texture;
  const title = tag("td", {}, missed.length ? name : tag("a", { href: file("textures", name, "htex") }, name));
  if (tags.length) title.append(tag("span", { class: "tags" }, tags.join(", ")));
  for (const [code, severity, message] of findings.filter(([, severity]) => severity !== "info")) {
    title.append(tag("span", { class: `finding ${severity}`, title: message }, code));
  }
  for (const [gate, reason] of missed) title.append(tag("span", { class: "reason" }, `left out (${gate}): ${reason}`));
  const each = errors.map(([model, error]) => {
    const below = repeatability !== undefined && error <= repeatability;
    return tag("span", below ? { class: "below", title: "below the repeatability" } : {}, `${model} ${error.toFixed(2)}`);
  });
  const sound = tag("td", {});
  if (!missed.length) {
    const play = tag("button", { class: "play", "aria-label": `play ${name}`, title: "a second of its sound" }, "▶");
    play.addEventListener("click", () => listen(texture, play));
    sound.append(play);
  }
  return tag("tr", {},
    title,
    tag("td", {}, ...(levels.length ? [spectrum(levels)] : [])),
    tag("td", { class: "errors number" }, ...each),
    tag("td", { class: "number" }, repeatability?.toFixed(2) ?? ""),
    tag("td", { class: "number" }, bytes ?? ""),
    tag("td", {}, license),
    sound);
}

const file = (folder, name, ending) => `${folder}/${name.split("/").map(encodeURIComponent).join("/")}.${ending}`;

let context;
async function listen(texture, button) {
  try {
    if (!browserPackage) return await new Audio(file("sounds", texture.name, "wav")).play();
    context ??= new AudioContext();
    const source = context.createBufferSource();
    source.buffer = await synthesized(texture);
    source.connect(context.destination);
    source.start();
  } catch (error) {
    button.title = `it cannot be played here: ${error.message}`;
    button.textContent = "!";
  }
}

// A second of the texture, rendered here by the browser package, at the loudness of all sounds.
async function synthesized(texture) {
  const { GuardedWorker, open } = await import("./browser/index.js");
  const asset = await open(file("textures", texture.name, "htex"));
  // A model that the texture brings along may not return: it runs in a worker, which is ended then.
  const worker = asset.hasModules ? new GuardedWorker() : null;
  const samples = worker ? await worker.render(asset, RATE, { rate: RATE }) : asset.voice({ rate: RATE }).render(RATE);
  worker?.end();
  const rms = Math.sqrt(samples.reduce((sum, x) => sum + x * x, 0) / samples.length);
  const buffer = context.createBuffer(1, samples.length, RATE);
  buffer.copyToChannel(samples.map((x) => (rms > 0 ? (0.1 * x) / rms : 0)), 0);
  return buffer;
}

function show() {
  const all = sorted(found());
  element("rows").replaceChildren(...all.slice(0, state.shown).map(row));
  element("count").textContent = `${all.length} of ${textures.length}`;
  element("more").hidden = all.length <= state.shown;
  for (const button of document.querySelectorAll("th button")) {
    const own = button.dataset.sort === state.sort;
    const direction = state.descending ? "descending" : "ascending";
    if (own) button.parentElement.setAttribute("aria-sort", direction);
    else button.parentElement.removeAttribute("aria-sort");
  }
  keepState();
}

element("summary").textContent =
  `${library.textures} textures in ${library.file}, ${library.bytes.toLocaleString("en")} bytes` +
  (library.left_out ? `; ${library.left_out} left out` : "") +
  (removed ? `; ${removed}` : "");
for (const { code, severity, textures, inLibrary, first } of findings) {
  const more = textures > first.length ? ", …" : "";
  const find = tag("button", { type: "button" }, code);
  find.addEventListener("click", () => {
    element("search").value = code;
    Object.assign(state, { query: code, shown: STEP });
    show();
  });
  element("findings").append(tag("li", { class: severity }, find, ` (${severity}): ${textures} ${textures === 1 ? "texture" : "textures"}, ${inLibrary} in the library: ${first.join(", ")}${more}`));
}
element("search").value = state.query;
element("left-out").checked = state.leftOut;
element("search").addEventListener("input", (event) => {
  Object.assign(state, { query: event.target.value, shown: STEP });
  show();
});
element("left-out").addEventListener("change", (event) => {
  Object.assign(state, { leftOut: event.target.checked, shown: STEP });
  show();
});
for (const button of document.querySelectorAll("th button")) {
  button.addEventListener("click", () => {
    const { sort } = button.dataset;
    Object.assign(state, { sort, descending: state.sort === sort && !state.descending, shown: STEP });
    show();
  });
}
element("more").addEventListener("click", () => {
  state.shown += STEP;
  show();
});
show();
