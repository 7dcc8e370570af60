// Pictures as the program drew them, by group; a click shows one as large as the window.
{
  // The SVG is ours, but it is read as XML and only what our pictures consist of is left in it all the same.
  const ELEMENTS = new Set("svg rect circle line polyline polygon path image text".split(" "));
  const ATTRIBUTES = new Set(
    ("viewBox width height x y x1 y1 x2 y2 cx cy r rx ry d dx dy points transform fill fill-opacity fill-rule opacity stroke stroke-width stroke-opacity " +
      "stroke-dasharray stroke-linecap stroke-linejoin font-family font-size font-weight font-style text-anchor dominant-baseline preserveAspectRatio class").split(" "),
  );
  const passes = ({ name, value }) => {
    if (name === "href") return /^data:image\/png;base64,[A-Za-z0-9+/=]*$/.test(value);
    if (name === "style") return value === "image-rendering:pixelated";
    return name === "xmlns" || (ATTRIBUTES.has(name) && !/url|[:\\]/i.test(value));
  };
  const strip = (node) => {
    for (const attribute of [...node.attributes]) if (!passes(attribute)) node.removeAttributeNode(attribute);
    for (const child of [...node.childNodes]) {
      const known = child.nodeType === Node.ELEMENT_NODE && child.namespaceURI === "http://www.w3.org/2000/svg" && ELEMENTS.has(child.nodeName);
      if (known) strip(child);
      else if (child.nodeType !== Node.TEXT_NODE) child.remove();
    }
  };

  // `name`: what it shows, for those who do not see it.
  page.picture = (text, name) => {
    const parsed = new DOMParser().parseFromString(text, "image/svg+xml").documentElement;
    if (parsed.nodeName !== "svg" || parsed.namespaceURI !== "http://www.w3.org/2000/svg") return page.element("p", { class: "notice" }, "This picture cannot be shown.");
    strip(parsed);
    if (!parsed.getAttribute("viewBox")) parsed.setAttribute("viewBox", `0 0 ${parsed.getAttribute("width") || 900} ${parsed.getAttribute("height") || 600}`);
    parsed.removeAttribute("width");
    parsed.removeAttribute("height");
    parsed.setAttribute("role", "img");
    parsed.setAttribute("aria-label", name);
    const paper = page.element("div", { class: "paper" });
    paper.append(document.importNode(parsed, true));
    return paper;
  };

  const enlarge = (paper, title) => {
    const dialog = page.element("dialog", { class: "large", "aria-label": title });
    const close = page.element("button", { type: "button", click: () => dialog.close() }, "Close");
    dialog.append(close, paper.cloneNode(true));
    dialog.addEventListener("click", (event) => event.target === dialog && dialog.close());
    dialog.addEventListener("close", () => dialog.remove());
    document.body.append(dialog);
    dialog.showModal();
  };

  const figureOf = (figure) => {
    const title = figure.title || figure.id;
    const paper = page.picture(figure.svg, title);
    const button = page.element("button", { type: "button", class: "no-print", click: () => enlarge(paper, title) }, "Enlarge");
    const head = page.element("div", { class: "title-line" }, page.element("strong", {}, title), page.element("div", { class: "save-buttons no-print" }, page.saveButtonsOf(title, figure.id, () => paper), button));
    const caption = page.element("figcaption", {}, head, figure.caption ? page.element("div", {}, figure.caption) : null, figure.csv ? page.element("div", { class: "muted" }, `numbers: ${figure.csv}`) : null);
    return page.element("figure", { class: "figure", id: `figure-${figure.id}`, "data-figure": figure.id }, caption, paper);
  };

  page.startFigures = () => {
    const { figures } = page.data;
    if (!figures || !figures.length) return;
    const section = page.byId("figures");
    section.hidden = false;
    const groups = d3.group(figures, (figure) => figure.group || "Pictures");
    for (const [group, members] of groups) section.append(page.element("h2", {}, group), page.element("div", { class: "figures" }, members.map(figureOf)));
  };
}
