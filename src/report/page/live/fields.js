// Fields for numbers, and what all controls share.
{
  // Every control: the part of the study that it changes, and what brings it up to date.
  page.controlParts = []; // { part, sync }

  page.tidy = (value) => Number(Number(value).toPrecision(12));

  // A number as people write it: "8.5", "8,5", "1 500". After a comma three digits may be thousands: that is no number here.
  page.numberOf = (text) => {
    const plain = text.replace(/[\s\u00a0\u2009\u202f]/g, "").replace("\u2212", "-");
    if (!/^[+-]?(\d+([.,]\d*)?|[.,]\d+)(e[+-]?\d+)?$/i.test(plain) || /^[+-]?[1-9]\d{0,2},\d{3}$/.test(plain)) return NaN;
    return Number(plain.replace(",", "."));
  };

  // `read` gives the number in force, `write` changes it, arrow keys by `step`.
  page.numberField = ({ id, part, label, step, read, write }) => {
    const field = page.element("input", { type: "text", inputmode: "decimal", autocomplete: "off", spellcheck: "false", id, "data-part": part, "aria-label": label });
    const put = (value) => {
      delete field.dataset.typed;
      field.setCustomValidity("");
      write(value);
      field.value = String(read());
    };
    field.addEventListener("input", () => (field.dataset.typed = "1"));
    field.addEventListener("change", (event) => {
      page.eventAt = event.timeStamp;
      if (field.value.trim() === "") return put(read());
      const value = page.numberOf(field.value);
      if (Number.isFinite(value)) return put(value);
      field.setCustomValidity("This is no number; write one such as 8.5 or 1500");
      return field.reportValidity();
    });
    field.addEventListener("keydown", (event) => {
      const by = { ArrowUp: step, ArrowDown: -step }[event.key];
      if (event.key === "Escape") put(read());
      if (!by) return;
      event.preventDefault();
      page.eventAt = event.timeStamp;
      put(page.tidy(read() + by));
    });
    // What is being typed stays.
    field.sync = () => {
      if (!field.dataset.typed) field.value = String(read());
    };
    return field;
  };

  page.controlHeading = ({ name, doc, unit }, ...more) => page.element("div", { class: "control-name", title: doc }, page.element("span", {}, page.breakable(name)), unit ? page.element("span", { class: "unit" }, page.unit(unit)) : null, more);

  // One word of several.
  page.wordSelect = ({ part, label, words, read, write }) => {
    const select = page.element("select", { "data-part": part, "aria-label": label }, words.map((word) => page.element("option", { value: word }, word)));
    select.addEventListener("change", (event) => {
      page.eventAt = event.timeStamp;
      write(select.value);
    });
    page.controlParts.push({ part, sync: () => (select.value = read()) });
    return select;
  };
}
