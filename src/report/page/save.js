// A plot as a file: SVG with the points as a picture in it, or PNG.
{
  const STYLES = ["fill", "fill-opacity", "stroke", "stroke-width", "stroke-opacity", "stroke-dasharray", "font-family", "font-size", "font-weight", "text-anchor", "opacity"];

  // A copy that needs no style sheet.
  const copied = (svg) => {
    const copy = svg.cloneNode(true);
    const from = [svg, ...svg.querySelectorAll("*")];
    const to = [copy, ...copy.querySelectorAll("*")];
    from.forEach((element, i) => {
      const style = getComputedStyle(element);
      if (style.display === "none") to[i].setAttribute("display", "none");
      for (const name of STYLES) to[i].setAttribute(name, style.getPropertyValue(name));
    });
    copy.querySelectorAll(".brush, .current").forEach((element) => element.remove());
    return copy;
  };

  // A stage has one canvas with the points below one SVG; the heads of parallel axes are text beside them.
  page.pictureOf = (stage) => {
    const [width, height] = [stage.clientWidth, stage.clientHeight];
    const place = (element) => {
      const [a, b] = [element.getBoundingClientRect(), stage.getBoundingClientRect()];
      return [a.left - b.left, a.top - b.top, a.width, a.height];
    };
    const parts = [`<rect width="${width}" height="${height}" fill="${page.variable("--ground")}"/>`];
    for (const canvas of stage.querySelectorAll("canvas")) {
      const [x, y, w, h] = place(canvas);
      parts.push(`<image x="${x}" y="${y}" width="${w}" height="${h}" href="${canvas.toDataURL()}"/>`);
    }
    for (const svg of stage.querySelectorAll("svg")) {
      const [x, y] = place(svg);
      parts.push(`<g transform="translate(${x},${y})">${new XMLSerializer().serializeToString(copied(svg))}</g>`);
    }
    const escape = (text) => text.replace(/&/g, "&amp;").replace(/</g, "&lt;");
    for (const head of stage.querySelectorAll(".axis-name, .axis-unit")) {
      const [x, y, w, h] = place(head);
      const style = getComputedStyle(head);
      parts.push(`<text x="${x + w / 2}" y="${y + h - 4}" text-anchor="middle" fill="${style.color}" font-family="sans-serif" font-size="10">${escape(head.textContent)}</text>`);
    }
    return { width, height, text: `<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${height}" viewBox="0 0 ${width} ${height}">${parts.join("")}</svg>` };
  };

  const save = async (stage, name, kind) => {
    const { width, height, text } = page.pictureOf(stage);
    if (kind === "svg") return page.download(`${name}.svg`, "image/svg+xml", text);
    const image = new Image();
    const address = URL.createObjectURL(new Blob([text], { type: "image/svg+xml" }));
    image.src = address;
    await image.decode();
    const canvas = page.element("canvas", { width: width * 2, height: height * 2 });
    const context = canvas.getContext("2d");
    context.scale(2, 2);
    context.drawImage(image, 0, 0);
    URL.revokeObjectURL(address);
    const blob = await new Promise((done) => canvas.toBlob(done, "image/png"));
    return page.download(`${name}.png`, "image/png", blob);
  };

  // Buttons beside the title of a section.
  page.saveButtons = (id, name) => {
    const title = typeof id === "string" ? page.byId(id) : id;
    if (!title || title.parentNode.querySelector(".save-buttons")) return;
    const stage = () => title.closest("section").querySelector(".stage");
    const button = (kind) => page.element("button", { type: "button", "data-testid": `${kind} ${name}`, "aria-label": `Save ${title.textContent} as ${kind.toUpperCase()}`, click: () => stage() && save(stage(), name, kind) }, kind.toUpperCase());
    const line = page.element("div", { class: "title-line" });
    title.replaceWith(line);
    line.append(title, page.element("div", { class: "save-buttons no-print" }, button("svg"), button("png")));
  };
}
