// Sliders and fields for what can be changed: constraints, objectives, loads, uncertainty, axes, and single values.
{
  const TITLES = {
    constraints: "Constraints",
    objectives: "Objectives",
    operation: "Operation",
    uncertainty: "Uncertainty",
    design: "Design axes",
    fixed: "Fixed values",
  };
  const BOUNDS = { min: "at least", max: "at most", above: "above", below: "below" };
  const controls = []; // { part, sync }

  // A round number near a step of which a slider has about two hundred.
  const niceStep = (span) => {
    const rough = span / 200;
    const ten = 10 ** Math.floor(Math.log10(rough));
    return [1, 2, 5, 10].find((it) => it * ten >= rough * 0.999) * ten;
  };

  const tidy = (value) => Number(Number(value).toPrecision(12));

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
    const field = page.element("input", { type: "number", step: "any", id, "data-part": part, "aria-label": `${name}, ${label}${unit ? `, in ${unit}` : ""}` });
    slider.addEventListener("input", (event) => {
      page.eventAt = event.timeStamp;
      const raw = Number(slider.value);
      // The slider has no steps of its own for plain numbers: round ones near it are taken, and its start is always one of them.
      const chosen = step ? tidy(value + Math.round((raw - value) / by) * by) : tidy(Math.round(raw / by) * by);
      write(chosen, part);
    });
    slider.addEventListener("change", page.endGesture);
    field.addEventListener("change", (event) => {
      page.eventAt = event.timeStamp;
      const text = field.value.trim();
      if (text === "" || !Number.isFinite(Number(text))) field.value = read();
      else write(Number(text), null);
    });
    const back = page.element("button", { type: "button", class: "back", title: `Back to ${page.short(original)}`, "aria-label": `${name}, ${label}: back to ${page.short(original)}`, click: () => write(original, null) }, "↺");
    const line = page.element("div", { class: "control" }, page.element("label", { for: id }, label), slider, page.element("span", { class: "entry" }, field, page.element("span", { class: "unit" }, page.unit(unit)), back));
    controls.push({
      part,
      sync: () => {
        const now = read();
        if (document.activeElement !== field) field.value = String(now);
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

  const heading = ({ name, doc, unit }, ...more) => page.element("div", { class: "control-name", title: doc }, page.element("span", {}, page.breakable(name)), unit ? page.element("span", { class: "unit" }, page.unit(unit)) : null, more);

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
    const off = (without) => {
      const parts = Object.fromEntries(Object.keys(control.bounds).map((key) => [`${control.part}.${key}`, null]));
      page.change({ ...(without ? parts : {}), [control.part]: without ? "off" : null });
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
    if (form === "rows") return page.element("div", { class: "block" }, heading(control, page.element("span", { class: "muted" }, ` ${page.count(control.rows)} rows, as the file has them`)));
    if (form === "list") {
      if (control.values.some((value) => typeof value === "string")) return page.element("div", { class: "block" }, heading(control, page.element("span", { class: "muted" }, ` ${control.values.join(", ")}`)));
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
    for (const [key, label] of [["from", "from"], ["to", "to"]]) {
      const step = control.step && !control.integer ? control.step : null;
      lines.push(single(control, `${part}.${key}`, tidy(control[key]), label, { step }));
    }
    if (control.count && !control.step) lines.push(single({ ...control, unit: "", low: 1, high: Math.max(control.count * 2, 41), integer: true }, `${part}.count`, control.count, "levels"));
    const levels = control.integer ? null : control.step ? page.element("span", { class: "muted" }, ` in steps of ${page.short(control.step)}`) : control.log ? page.element("span", { class: "muted" }, " log") : null;
    return page.element("div", { class: "block", "data-control": part }, heading(control, levels), lines);
  };

  const fixed = (control) => {
    const { part, value, words } = control;
    const block = (...children) => page.element("div", { class: "block", "data-control": part }, heading(control), children);
    if (typeof value !== "string") return block(single(control, part, value, "value"));
    if (!control.only_words) return page.element("div", { class: "block one-line", "data-control": part }, heading(control), page.element("span", { class: "muted" }, value));
    const select = page.element("select", { "data-part": part, "aria-label": control.name }, words.map((word) => page.element("option", { value: word }, word)));
    select.addEventListener("change", (event) => ((page.eventAt = event.timeStamp), put(part, select.value, value, null)));
    controls.push({ part, sync: () => (select.value = page.changedValue(part) ?? value) });
    return page.element("div", { class: "block one-line", "data-control": part }, heading(control), select);
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
    box.replaceChildren(
      ...wanted.map((part) => {
        const [table, name, key] = part.split(".");
        const remove = page.element("button", { type: "button", class: "back", title: "Take it away", "aria-label": `${name} ${BOUNDS[key]}: take it away`, click: () => page.change({ [part]: null }) }, "×");
        return page.element("div", { class: "block" }, heading({ name, doc: "a bound that was added here" }, remove), added(`${table}.${name}`, key));
      }),
    );
    controls.slice(before).forEach((it) => (it.added = true));
  };

  const sync = () => {
    syncAdded();
    controls.forEach((it) => it.sync());
    page.byId("undo").disabled = !page.canUndo();
    page.byId("redo").disabled = !page.canRedo();
    page.byId("reset").disabled = page.changes().size === 0;
  };

  page.startControls = () => {
    const { controls: of } = page.data;
    const box = page.byId("controls");
    const button = (id, label, text, click) => page.element("button", { type: "button", id, "data-testid": id, title: label, "aria-label": label, click }, text);
    const given = of.fixed.filter((it) => it.given);
    const others = of.fixed.filter((it) => !it.given);
    const further = others.length ? page.element("details", { "data-group": "others" }, page.element("summary", {}, "Other inputs, at their defaults", page.element("span", { class: "muted" }, ` ${others.length}`)), others.map(fixed)) : null;
    const asItIs = [...of.formulas.map((name) => `${name}: a formula`), ...of.drawn.map((name) => `${name}: drawn from a distribution`)];
    box.replaceChildren(
      page.element(
        "div",
        { class: "controls-head" },
        page.element("h2", {}, "Change the study"),
        page.element("div", { class: "controls-buttons" }, button("undo", "Undo (Ctrl+Z)", "↶", page.undoChange), button("redo", "Do it again (Ctrl+Y)", "↷", page.redoChange), button("reset", "Reset to the study as its file has it", "Reset", () => page.resetChanges())),
      ),
      ...[
        group("constraints", of.constraints, constraint, true),
        page.element("div", { id: "added" }),
        group("operation", of.operation, axis, true),
        group("uncertainty", of.uncertainty, axis, true),
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
      const typing = event.target.tagName === "INPUT" && event.target.type === "number";
      const key = event.key.toLowerCase();
      if (typing) return;
      if (key === "z" && !event.shiftKey) page.undoChange();
      else if (key === "y" || (key === "z" && event.shiftKey)) page.redoChange();
      else return;
      event.preventDefault();
    });
    sync();
  };
}
