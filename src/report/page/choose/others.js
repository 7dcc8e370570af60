// Other results over this one: chosen as files or dropped on the plots, drawn as marks of their own, named, counted, taken away.
{
  const MOST = 3;
  const KINDS = ["square", "cross", "diamond"];
  page.others = [];
  let box = null;

  // The marks as pixels around their middle.
  const outlines = {
    square: (r) => d3.range(-r, r + 1).flatMap((i) => [[i, -r], [i, r], [-r, i], [r, i]]),
    cross: (r) => d3.range(-r, r + 1).flatMap((i) => [[i, i], [i, -i], [i + 1, i], [i + 1, -i]]),
    diamond: (r) => d3.range(-r, r + 1).flatMap((i) => [[i, r - Math.abs(i)], [i, Math.abs(i) - r], [i + 1, r - Math.abs(i)], [i + 1, Math.abs(i) - r]]),
  };
  const thick = (spots, ratio) => (ratio > 1.4 ? spots.flatMap(([dx, dy]) => [[dx, dy], [dx + 1, dy], [dx, dy + 1]]) : spots);
  // Larger than the points of this front, which lie over them.
  const radius = () => [[20000, 2], [4000, 3], [300, 4], [0, 5]].find(([rows]) => page.front.rows >= rows)[1];
  page.otherMark = ({ kind, rows }, ratio) => (rows > 20000 ? page.disc(0.7) : thick(outlines[kind](Math.round(radius() * ratio)), ratio).map(([dx, dy]) => ({ dx, dy, cover: 256 })));
  page.otherColour = ({ kind }) => page.variable(`--other-${kind}`);

  const swatch = (kind) => {
    const svg = d3.create("svg").attr("class", `other-mark ${kind}`).attr("width", 13).attr("height", 13).attr("aria-hidden", "true");
    svg.append("path").attr("d", { square: "M2.5,2.5h8v8h-8z", cross: "M2.5,2.5l8,8M2.5,10.5l8,-8", diamond: "M6.5,1.5l5,5l-5,5l-5,-5z" }[kind]);
    return svg.node();
  };

  const nameOf = ({ title, folder, file }) => (title ? `${title} (${folder ? `${folder}/` : ""}${file})` : file);

  const verdict = (other) => {
    if (other.problem) return `It cannot be compared now: ${other.problem}.`;
    if (!other.counts) return "comparing …";
    const { ownBeaten, theirBeaten } = other.counts;
    const csv = other.goals ? "" : " The table does not say its goals and units: they are taken to be those here.";
    return `${page.count(theirBeaten)} of its ${page.count(other.rows)} designs ${theirBeaten === 1 ? "is" : "are"} beaten by one of this front, ${page.count(ownBeaten)} of the ${page.count(page.front.rows)} here by one of its.${csv}`;
  };

  const say = (text) => {
    const line = box.querySelector("[role=alert]");
    line.hidden = !text;
    line.textContent = text;
  };

  const legend = () => {
    const item = (other) => page.element("li", { "data-testid": `other ${other.kind}` }, swatch(other.kind), page.element("strong", {}, nameOf(other)), ` ${verdict(other)}`, page.element("button", { type: "button", class: "back no-print", "aria-label": `Take away ${nameOf(other)}`, title: "Take it away", click: () => remove(other) }, "×"));
    const list = box.querySelector("ul");
    list.hidden = !page.others.length;
    page.keepFocus(list, () => list.replaceChildren(...page.others.map(item)));
    box.querySelector("button[data-testid=load-other]").disabled = page.others.length >= MOST;
    // What is over the plots is named on paper too; the button is not.
    box.classList.toggle("no-print", !page.others.length);
  };

  const remove = (other) => {
    page.others = page.others.filter((it) => it !== other);
    say("");
    legend();
    page.events.call("others");
    box.querySelector("button").focus();
  };

  page.addOther = async (file) => {
    say("");
    let found = null;
    try {
      if (page.others.length >= MOST) throw new Error(`${MOST} other results are shown already; take one away first`);
      found = await page.readResult(file);
    } catch (error) {
      return say(`${file.name} cannot be shown here: ${error.message}.`);
    }
    const other = { ...found, kind: KINDS.find((kind) => page.others.every((it) => it.kind !== kind)), counts: null };
    page.others = [...page.others, other];
    legend();
    page.events.call("others");
    await compare(other);
    return null;
  };

  // Counts anew for the front that is shown; who is overtaken by another front gives up.
  const compare = async (other) => {
    const { front } = page;
    if (!front.rows) return;
    try {
      other.problem = null;
      page.checkResult(other);
    } catch (error) {
      other.problem = error.message;
      return void legend();
    }
    const counts = await page.compareFronts(other, () => !page.others.includes(other) || page.front !== front);
    if (page.front !== front || !counts) return;
    other.counts = counts;
    legend();
  };

  const addAll = async (files) => {
    for (const file of files) await page.addOther(file);
  };

  page.startOthers = () => {
    if (!page.front.objectives.length) return;
    const input = page.element("input", { type: "file", accept: ".html,.csv", multiple: true, hidden: true, id: "other-file", "aria-label": "Another result" });
    input.addEventListener("change", async () => {
      await addAll([...input.files]);
      input.value = "";
    });
    const button = page.element("button", { type: "button", "data-testid": "load-other", class: "no-print", title: "report.html or front.csv of another result; it stays on this machine", click: () => input.click() }, "Load another result");
    box = page.element("div", { id: "others", "data-testid": "others" }, page.element("ul", { hidden: true, role: "list" }), page.element("p", { role: "alert", class: "notice", hidden: true }), button, input, page.element("span", { class: "hint no-print" }, " or drop its report.html or front.csv on the plots"));
    const section = page.byId("matrix-section");
    page.byId("splom").before(box);
    section.addEventListener("dragover", (event) => {
      if (![...event.dataTransfer.types].includes("Files")) return;
      event.preventDefault();
      section.classList.add("dropping");
    });
    section.addEventListener("dragleave", () => section.classList.remove("dropping"));
    section.addEventListener("drop", (event) => {
      if (!event.dataTransfer.files.length) return;
      event.preventDefault();
      section.classList.remove("dropping");
      addAll([...event.dataTransfer.files]);
    });
    legend();
    const again = page.afterPause(400, () => page.others.forEach(compare));
    page.events.on("front.others", () => {
      for (const other of page.others) other.counts = null;
      if (page.others.length) legend();
      again();
    });
  };
}
