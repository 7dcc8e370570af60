// What is drawn on the page as a file: SVG, with what stands on canvases as pictures in it, or PNG.
{
  const STYLES = (
    "fill fill-opacity fill-rule stroke stroke-width stroke-opacity stroke-dasharray stroke-linecap stroke-linejoin paint-order " +
    "font-family font-size font-weight font-style text-anchor dominant-baseline opacity"
  ).split(" ");
  const LEFT_OUT = ".no-print, .offscreen, .brush, .current, .current-line, .strip-current, .map-cell, title, desc";

  const escape = (text) => text.replace(/&/g, "&amp;").replace(/</g, "&lt;");
  const near = (number) => Number(number.toFixed(2));

  // A copy that needs no style sheet, as large as it is shown.
  const copied = (svg, { x, y, width, height }) => {
    const copy = svg.cloneNode(true);
    const from = [svg, ...svg.querySelectorAll("*")];
    const to = [copy, ...copy.querySelectorAll("*")];
    from.forEach((element, i) => {
      const style = getComputedStyle(element);
      if (style.display === "none") to[i].setAttribute("display", "none");
      for (const name of STYLES) to[i].setAttribute(name, style.getPropertyValue(name));
      to[i].removeAttribute("style");
    });
    copy.querySelectorAll(LEFT_OUT).forEach((element) => element.remove());
    if (!copy.getAttribute("viewBox")) copy.setAttribute("viewBox", `0 0 ${near(width)} ${near(height)}`);
    for (const [name, value] of Object.entries({ x, y, width, height })) copy.setAttribute(name, near(value));
    copy.setAttribute("overflow", "visible");
    return new XMLSerializer().serializeToString(copy);
  };

  // The lines of a text as the page breaks it: { text, left, right, top, bottom }.
  const linesOf = (node) => {
    const range = document.createRange();
    const lines = [];
    for (let i = 0; i < node.length; i++) {
      range.setStart(node, i);
      range.setEnd(node, i + 1);
      const [at] = range.getClientRects();
      const isSpace = /\s/.test(node.data[i]);
      if (!at || !at.width) continue;
      const last = lines[lines.length - 1];
      const goesOn = last && Math.abs(last.top - at.top) < 2;
      if (goesOn && isSpace) last.spaces += " ";
      else if (goesOn) Object.assign(last, { text: last.text + last.spaces + node.data[i], spaces: "", right: at.right });
      else if (!isSpace) lines.push({ text: node.data[i], spaces: "", left: at.left, right: at.right, top: at.top, bottom: at.bottom });
    }
    return lines;
  };

  // From where to where a box can be seen: what scrolls or is cut off shows a part of itself only.
  const shownOf = (element, style, clip) => {
    if (style.overflowY === "visible" || element.scrollHeight <= element.clientHeight + 1) return clip;
    const { top, bottom } = element.getBoundingClientRect();
    return { top: Math.max(top, clip.top), bottom: Math.min(bottom, clip.bottom) };
  };

  // Everything in some boxes, which stand below one another: canvases, SVGs, coloured areas and words.
  page.pictureOf = (boxes) => {
    const rects = boxes.map((box) => box.getBoundingClientRect());
    const [left, right, top, bottom] = [d3.min(rects, (it) => it.left), d3.max(rects, (it) => it.right), d3.min(rects, (it) => it.top), d3.max(rects, (it) => it.bottom)];
    const origin = { left, top, width: right - left, height: bottom - top };
    const parts = [];
    let [width, height] = [origin.width, origin.height];
    const placeOf = (rect) => {
      const place = { x: rect.left - origin.left, y: rect.top - origin.top, width: rect.width, height: rect.height };
      [width, height] = [Math.max(width, place.x + place.width), Math.max(height, place.y + place.height)];
      return place;
    };
    const text = (node, clip) => {
      const style = getComputedStyle(node.parentElement);
      const size = parseFloat(style.fontSize);
      for (const line of linesOf(node).filter((it) => it.top >= clip.top && it.bottom <= clip.bottom)) {
        const { x, y, width: long, height: high } = placeOf({ left: line.left, top: line.top, width: line.right - line.left, height: line.bottom - line.top });
        parts.push(`<text x="${near(x)}" y="${near(y + high / 2 + 0.35 * size)}" textLength="${near(long)}" lengthAdjust="spacingAndGlyphs" fill="${style.color}" font-family="${style.fontFamily.replace(/"/g, "'")}" font-size="${size}" font-weight="${style.fontWeight}">${escape(line.text)}</text>`);
      }
    };
    const visit = (element, outer) => {
      if (element.matches(LEFT_OUT)) return;
      const style = getComputedStyle(element);
      const rect = element.getBoundingClientRect();
      if (style.display === "none" || style.visibility === "hidden") return;
      if (rect.height && (rect.top >= outer.bottom || rect.bottom <= outer.top)) return;
      const clip = shownOf(element, style, outer);
      if (element.localName === "svg") return void parts.push(copied(element, placeOf(rect)));
      const { x, y, width: wide, height: high } = rect.width && rect.height ? placeOf(rect) : {};
      if (element.localName === "canvas") return void (wide && parts.push(`<image x="${near(x)}" y="${near(y)}" width="${near(wide)}" height="${near(high)}" href="${element.toDataURL()}"/>`));
      if (wide && element.dataset.bands) {
        // Bars of colours, one below the other.
        const bands = JSON.parse(element.dataset.bands);
        bands.forEach((stops, band) => {
          const id = `gradient-${parts.length}`;
          const part = high / bands.length;
          parts.push(`<linearGradient id="${id}">${stops.map((colour, i) => `<stop offset="${i / (stops.length - 1)}" stop-color="${colour}"/>`).join("")}</linearGradient>`);
          parts.push(`<rect x="${near(x)}" y="${near(y + band * part)}" width="${near(wide)}" height="${near(part)}" fill="url(#${id})"/>`);
        });
      } else if (wide && d3.color(style.backgroundColor)?.opacity > 0) parts.push(`<rect x="${near(x)}" y="${near(y)}" width="${near(wide)}" height="${near(high)}" fill="${style.backgroundColor}"/>`);
      // What is folded up is not seen.
      const shown = element.localName === "details" && !element.open ? element.querySelectorAll(":scope > summary") : element.childNodes;
      for (const child of shown) {
        if (child.nodeType === Node.TEXT_NODE) text(child, clip);
        else if (child.nodeType === Node.ELEMENT_NODE) visit(child, clip);
      }
    };
    boxes.forEach((box) => visit(box, { top: -Infinity, bottom: Infinity }));
    [width, height] = [Math.ceil(width), Math.ceil(height)];
    const ground = `<rect width="${width}" height="${height}" fill="${page.variable("--ground")}"/>`;
    return { width, height, text: `<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${height}" viewBox="0 0 ${width} ${height}">${ground}${parts.join("")}</svg>` };
  };

  const save = async (boxes, name, kind) => {
    const { width, height, text } = page.pictureOf(boxes);
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

  // The name of a file may have no sign that some system forbids.
  const fileName = (name) => name.replace(/[^A-Za-z0-9_.-]+/g, "-");

  // Two buttons that save what `boxOf` finds, a box or several; `what` says what that is.
  page.saveButtonsOf = (what, name, boxOf) => {
    const button = (kind) => page.element("button", { type: "button", "data-testid": `${kind} ${name}`, "aria-label": `Save ${what} as ${kind.toUpperCase()}`, click: () => boxOf() && save([boxOf()].flat(), fileName(name), kind) }, kind.toUpperCase());
    return page.element("div", { class: "save-buttons no-print" }, button("svg"), button("png"));
  };

  // The same beside the title of a section; of its stage, if nothing else is said.
  page.saveButtons = (title, name, boxOf = () => title.closest("section").querySelector(".stage")) => {
    if (!title || title.parentNode.querySelector(":scope > .save-buttons")) return;
    const line = page.element("div", { class: "title-line" });
    title.replaceWith(line);
    line.append(title, page.saveButtonsOf(title.textContent, name, boxOf));
  };
}
