// Sliders and fields for what can be changed: constraints, objectives, loads, uncertainty, axes, and single values.
{
  const TITLES = {
    constraints: "Constraints",
    objectives: "Objectives",
    operation: "Operation",
    uncertainty: "Uncertainty",
    drawn: "Distributions",
    design: "Design axes",
    fixed: "Fixed values",
  };
  const MOST_FIELDS = 8; // of a list
  const BOUNDS = { min: "at least", max: "at most", above: "above", below: "below" };
  const { controlParts: controls, controlHeading: heading, tidy } = page;

  // A round number near a step of which a slider has about two hundred.
  const niceStep = (span) => {
    const rough = span / 200;
    const ten = 10 ** Math.floor(Math.log10(rough));
    return [1, 2, 5, 10].find((it) => it * ten >= rough * 0.999) * ten;
  };

  // A number with its slider. `read` gives the value in force, `write` changes it.
  const numberControl = ({ part, label, name, unit, low, high, integer, step, read, write, original }) => {
    const value = read();
    const span = { low: Math.min(low ?? value, value), high: Math.max(high ?? value, value) };
    if (!(span.high > span.low)) Object.assign(span, { low: value - (Math.abs(value) || 1), high: value + (Math.abs(value) || 1) });
    const by = step || (integer ? 1 : niceStep(span.high - span.low));
    const start = step ? value - Math.floor((value - span.low) / by) * by : Math.ceil(span.low / by - 1e-9) * by;
    const id = `control ${part}`;
    const ends = [tidy(start), tidy(Math.max(span.high, start + by))];
    const slider = page.element("input", { type: "range", min: ends[0], max: ends[1], step: step || integer ? tidy(by) : "any", "aria-label": `${name}, ${label}`, "data-part": part, tabindex: 0 });
    const field = page.numberField({ id, part, label: `${name}, ${label}${unit ? `, in ${unit}` : ""}`, step: tidy(by), read, write: (value) => write(value, null) });
    slider.addEventListener("input", (event) => {
      page.eventAt = event.timeStamp;
      const raw = Number(slider.value);
      // The slider has no steps of its own for plain numbers: round ones near it are taken, and its start is always one of them.
      const chosen = step ? tidy(value + Math.round((raw - value) / by) * by) : tidy(Math.round(raw / by) * by);
      write(chosen, part);
    });
    slider.addEventListener("change", page.endGesture);
    const back = page.element("button", { type: "button", class: "back", title: `Back to ${page.short(original)}`, "aria-label": `${name}, ${label}: back to ${page.short(original)}`, click: () => (field.focus(), write(original, null)) }, "↺");
    const line = page.element("div", { class: "control" }, page.element("label", { for: id }, label), slider, page.element("span", { class: "entry" }, field, page.element("span", { class: "unit" }, page.unit(unit)), back));
    controls.push({
      part,
      sync: () => {
        const now = read();
        field.sync();
        // A value beyond its ends stretches a slider only as long as it stands.
        slider.min = Math.min(ends[0], now);
        slider.max = Math.max(ends[1], now);
        if (Number(slider.value) !== now) slider.value = now;
        line.classList.toggle("changed", now !== original && !Number.isNaN(original));
        back.hidden = now === original || Number.isNaN(original);
      },
    });
    return line;
  };

  const put = (part, value, original, drag) => page.change({ [part]: value === original ? null : value }, drag);
  const valueOf = (part, original) => (page.changedValue(part) === undefined ? original : Number(page.changedValue(part)));

  const single = (control, part, original, label, more = {}) =>
    numberControl({
      part,
      label,
      name: control.name,
      unit: control.unit,
      low: control.low,
      high: control.high,
      integer: control.integer,
      original,
      read: () => valueOf(part, original),
      write: (value, drag) => put(part, value, original, drag),
      ...more,
    });

  const toggle = (part, name, off) => {
    const box = page.element("input", { type: "checkbox", "data-part": part, "aria-label": `${name} counts`, change: (event) => ((page.eventAt = event.timeStamp), off(!box.checked)) });
    controls.push({ part, sync: () => (box.checked = page.changedValue(part) !== "off") });
    return box;
  };

  const constraint = (control) => {
    const lines = Object.entries(control.bounds).map(([key, original]) => {
      const pad = ((control.high ?? original) - (control.low ?? original)) * 0.1 || Math.abs(original) * 0.5 || 1;
      return single({ ...control, low: Math.min(original, control.low ?? original) - pad, high: Math.max(original, control.high ?? original) + pad }, `${control.part}.${key}`, original, BOUNDS[key]);
    });
    // Bounds that were moved are there again when it counts again.
    let moved = {};
    const off = (without) => {
      const parts = Object.keys(control.bounds).map((key) => `${control.part}.${key}`);
      if (without) moved = Object.fromEntries(parts.map((part) => [part, page.changedValue(part) ?? null]));
      page.change(without ? { ...Object.fromEntries(parts.map((part) => [part, null])), [control.part]: "off" } : { ...moved, [control.part]: null });
    };
    return page.element("div", { class: "block", "data-control": control.part }, heading(control, toggle(control.part, control.name, off)), lines);
  };

  // A constraint on something that the file does not bound, from a range that was brushed.
  page.constrain = (name, bounds) => {
    const known = page.data.controls.constraints.find((it) => it.of === name);
    const part = known ? known.part : `constraints.${name}`;
    page.change(Object.fromEntries(Object.entries(bounds).map(([key, value]) => [`${part}.${key}`, value])));
  };

  const added = (part, key) => {
    const name = part.split(".")[1];
    const column = page.front && page.front.byName.get(name);
    const [low, high] = column ? page.domain(column) : [null, null];
    return single({ name, unit: column ? column.unit : "", low, high }, `${part}.${key}`, NaN, BOUNDS[key]);
  };

  const objective = (control) => {
    const { part, goal, plain } = control;
    const key = plain ? part : `${part}.goal`;
    const select = page.element("select", { "data-part": key, "aria-label": `${control.name}: goal` }, ["min", "max", "off"].map((it) => page.element("option", { value: it }, it === "off" ? "does not count" : it)));
    select.addEventListener("change", (event) => {
      page.eventAt = event.timeStamp;
      const { value } = select;
      if (value === "off") page.change({ [key]: null, [part]: "off" });
      else page.change({ [part]: null, [key]: value === goal ? null : value });
    });
    controls.push({ part: key, sync: () => (select.value = page.changedValue(part) === "off" ? "off" : (page.changedValue(key) ?? goal)) });
    return page.element("div", { class: "block one-line", "data-control": part }, heading(control), select);
  };

  const axis = (control) => {
    const { part, form } = control;
    if (form === "table") return page.tableControl(control);
    if (form === "rows") return page.element("div", { class: "block" }, heading(control, page.element("span", { class: "muted" }, ` ${page.count(control.rows)} rows, as the file has them`)));
    if (form === "list") {
      if (control.values.every((value) => control.words.includes(value))) return page.wordsControl(control);
      if (control.values.length > MOST_FIELDS || control.values.some((value) => typeof value === "string")) return page.listControl(control);
      // What stands in the address may be no list.
      const given = (text) => {
        try {
          const list = JSON.parse(text);
          return Array.isArray(list) && list.length === control.values.length ? list : control.values;
        } catch {
          return control.values;
        }
      };
      const now = () => (page.changedValue(part) === undefined ? control.values : given(page.changedValue(part)));
      const lines = control.values.map((original, at) =>
        numberControl({
          ...control,
          part: `${part} ${at + 1}`,
          label: control.values.length === 1 ? "value" : `value ${at + 1}`,
          original,
          read: () => now()[at],
          write: (value, drag) => {
            const list = now().map((it, i) => (i === at ? value : it));
            page.change({ [part]: String(list) === String(control.values) ? null : `[${list.join(", ")}]` }, drag && `${part} ${at}`);
          },
        }),
      );
      return page.element("div", { class: "block", "data-control": part }, heading(control), lines);
    }
    const lines = [];
    const step = control.step && !control.integer ? control.step : null;
    const gap = step ?? (control.integer ? 1 : niceStep((control.high ?? control.to) - (control.low ?? control.from)));
    const end = (key) => valueOf(`${part}.${key}`, tidy(control[key]));
    for (const key of ["from", "to"]) {
      const original = tidy(control[key]);
      // A slider stops before the other end.
      const within = (value, drag) => (drag === null ? value : key === "from" ? Math.min(value, tidy(end("to") - gap)) : Math.max(value, tidy(end("from") + gap)));
      lines.push(single(control, `${part}.${key}`, original, key, { step, write: (value, drag) => put(`${part}.${key}`, within(value, drag), original, drag) }));
    }
    if (control.count && !control.step) lines.push(single({ ...control, unit: "", low: control.from === control.to ? 1 : 2, high: Math.max(control.count * 2, 41), integer: true }, `${part}.count`, control.count, "levels"));
    const levels = control.integer ? null : control.step ? page.element("span", { class: "muted" }, ` in steps of ${page.short(control.step)}`) : control.log ? page.element("span", { class: "muted" }, " log") : null;
    return page.element("div", { class: "block", "data-control": part }, heading(control, levels), lines);
  };

  const fixed = (control) => {
    const { part, value, words } = control;
    const block = (...children) => page.element("div", { class: "block", "data-control": part }, heading(control), children);
    if (words.length && !control.only_words) return wordOrNumber(control);
    if (typeof value !== "string") return block(single(control, part, value, "value"));
    const select = page.wordSelect({ part, label: control.name, words, read: () => page.changedValue(part) ?? value, write: (word) => put(part, word, value, null) });
    return page.element("div", { class: "block one-line", "data-control": part }, heading(control), select);
  };

  // A number, or a word in place of one.
  const wordOrNumber = (control) => {
    const { part, value, words } = control;
    const NUMBER = "a number";
    const now = () => page.changedValue(part) ?? value;
    const word = () => (words.includes(now()) ? now() : NUMBER);
    let last = typeof value === "number" ? value : tidy(control.low ?? 0);
    const line = single(control, part, value, "value", {
      original: typeof value === "number" ? value : NaN,
      read: () => (word() === NUMBER ? (last = Number(now())) : last),
    });
    const select = page.wordSelect({ part, label: control.name, words: [...words, NUMBER], read: word, write: (chosen) => put(part, chosen === NUMBER ? last : chosen, value, null) });
    controls.push({ part, sync: () => (line.hidden = word() !== NUMBER) });
    return page.element("div", { class: "block", "data-control": part }, heading(control, select), line);
  };

  // A distribution: the numbers in it.
  const law = (control) => {
    const line = ({ part, label, value, low, high, integer }) => single({ name: control.name, unit: "", low, high, integer }, part, value, label);
    return page.element("div", { class: "block", "data-control": control.fields[0]?.part }, heading(control, page.element("span", { class: "muted" }, ` ${control.law}`)), control.fields.map(line));
  };

  const group = (key, list, build, open) => {
    if (!list.length) return null;
    return page.element("details", { open, "data-group": key }, page.element("summary", {}, TITLES[key], page.element("span", { class: "muted" }, ` ${list.length}`)), list.map(build));
  };

  // Bounds that the file does not have, such as those that were made of a brushed range.
  const syncAdded = () => {
    const box = page.byId("added");
    const known = new Set(page.data.controls.constraints.flatMap((it) => Object.keys(it.bounds).map((key) => `${it.part}.${key}`)));
    const wanted = [...page.changes().keys()].filter((part) => part.startsWith("constraints.") && part.split(".").length === 3 && !known.has(part));
    if (box.dataset.parts === String(wanted)) return;
    box.dataset.parts = String(wanted);
    for (let i = controls.length - 1; i >= 0; i--) if (controls[i].added) controls.splice(i, 1);
    const before = controls.length;
    const block = (part) => {
      const [table, name, key] = part.split(".");
      const remove = page.element("button", { type: "button", class: "back", title: "Take it away", "aria-label": `${name} ${BOUNDS[key]}: take it away`, click: () => page.change({ [part]: null }) }, "×");
      return page.element("div", { class: "block" }, heading({ name, doc: "a bound that was added here" }, remove), added(`${table}.${name}`, key));
    };
    page.keepFocus(box, () => box.replaceChildren(...wanted.map(block)), ".controls-buttons button:not(:disabled)");
    controls.slice(before).forEach((it) => (it.added = true));
  };

  const sync = () => {
    syncAdded();
    controls.forEach((it) => it.sync());
    page.keepFocus(document.querySelector(".controls-buttons"), () => {
      page.byId("undo").disabled = !page.canUndo();
      page.byId("redo").disabled = !page.canRedo();
      page.byId("reset").disabled = page.changes().size === 0;
    });
  };

  page.startControls = () => {
    const { controls: of } = page.data;
    const box = page.byId("controls");
    const button = (id, label, text, click) => page.element("button", { type: "button", id, "data-testid": id, title: label, "aria-label": label, click }, text);
    const given = of.fixed.filter((it) => it.given);
    const others = of.fixed.filter((it) => !it.given);
    const further = others.length ? page.element("details", { "data-group": "others" }, page.element("summary", {}, "Other inputs, at their defaults", page.element("span", { class: "muted" }, ` ${others.length}`)), others.map(fixed)) : null;
    const asItIs = of.formulas.map((name) => `${name}: a formula`);
    box.replaceChildren(
      page.element(
        "div",
        { class: "controls-head" },
        page.element("h2", {}, "Change the study"),
        page.element("div", { class: "controls-buttons" }, button("undo", "Undo (Ctrl+Z)", "↶", page.undoChange), button("redo", "Do it again (Ctrl+Y)", "↷", page.redoChange), button("reset", "Reset to the study as this page was started with", "Reset", () => page.resetChanges())),
      ),
      ...[
        group("constraints", of.constraints, constraint, true),
        page.element("div", { id: "added" }),
        group("operation", of.operation, axis, true),
        group("uncertainty", of.uncertainty, axis, true),
        group("drawn", of.drawn, law, true),
        group("fixed", given, fixed, true),
        group("design", of.design, axis, of.design.length < 5),
        group("objectives", of.objectives, objective, false),
        further,
        asItIs.length ? page.element("p", { class: "hint" }, `As the file has it: ${asItIs.join("; ")}.`) : null,
      ].filter(Boolean),
    );
    box.hidden = false;
    document.body.classList.add("with-controls");
    page.events.on("changes.controls", sync);
    document.addEventListener("keydown", (event) => {
      if (!(event.ctrlKey || event.metaKey) || event.altKey) return;
      const key = event.key.toLowerCase();
      // What is being typed has an undo of its own.
      if (event.target.dataset?.typed) return;
      if (key === "z" && !event.shiftKey) page.undoChange();
      else if (key === "y" || (key === "z" && event.shiftKey)) page.redoChange();
      else return;
      event.preventDefault();
    });
    sync();
  };
}
