// Pictures as the program drew them, by group; a click shows one as large as the window.
{
  // The SVG is ours, but it is read as XML and stripped of scripts and listeners all the same.
  page.picture = (text) => {
    const parsed = new DOMParser().parseFromString(text, "image/svg+xml").documentElement;
    if (parsed.nodeName !== "svg") return page.element("p", { class: "notice" }, "This picture cannot be shown.");
    parsed.querySelectorAll("script, foreignObject").forEach((node) => node.remove());
    if (!parsed.getAttribute("viewBox")) parsed.setAttribute("viewBox", `0 0 ${parsed.getAttribute("width") || 900} ${parsed.getAttribute("height") || 600}`);
    parsed.removeAttribute("width");
    parsed.removeAttribute("height");
    parsed.setAttribute("role", "img");
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
    const paper = page.picture(figure.svg);
    const title = figure.title || figure.id;
    paper.querySelector("svg")?.setAttribute("aria-label", title);
    const button = page.element("button", { type: "button", class: "no-print", click: () => enlarge(paper, title) }, "Enlarge");
    const head = page.element("div", { class: "title-line" }, page.element("strong", {}, title), button);
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
