// Printed against computed numbers, grouped, with the reason where they differ.
{
  page.startComparison = () => {
    const { comparison } = page.data;
    if (!comparison || !comparison.length) return;
    const section = page.byId("comparison");
    section.hidden = false;
    const head = [["quantity", ""], ["unit", ""], ["printed", "number"], ["computed", "number"], ["difference", "number"], ["reason", ""]];
    const line = (row) => {
      const cell = (text, kind) => page.element("td", { class: kind }, text ?? "");
      return page.element("tr", {}, page.element("th", { scope: "row" }, row.what), cell(row.unit), cell(row.printed, "number"), cell(row.computed, "number"), cell(row.difference, "number"), cell(row.reason, "reason"));
    };
    const bodies = [...d3.group(comparison, (row) => row.group || "")].map(([group, rows]) => page.element("tbody", {}, group ? page.element("tr", { class: "group" }, page.element("th", { colspan: 6, scope: "rowgroup" }, group)) : null, rows.map(line)));
    const table = page.element("table", { class: "comparison" }, page.element("thead", {}, page.element("tr", {}, head.map(([name, kind]) => page.element("th", { scope: "col", class: kind }, name)))), bodies);
    section.append(page.element("h2", { id: "comparison-title" }, "Printed and computed"), page.element("div", { class: "scroll" }, table));
  };

  // top.csv, already text.
  page.startTop = () => {
    const { top } = page.data;
    if (!top || !top.rows.length) return;
    const section = page.byId("tally");
    const head = top.columns.map((name, i) => page.element("th", { scope: "col", class: "number" }, name, top.units && top.units[i] ? page.element("span", { class: "unit" }, top.units[i]) : null));
    const shorten = (text) => (text !== "" && Number.isFinite(Number(text)) ? page.short(Number(text)) : text);
    const line = (row) => page.element("tr", {}, row.map((text) => page.element("td", { class: "number", title: text }, shorten(text))));
    const table = page.element("table", {}, page.element("thead", {}, page.element("tr", {}, head)), page.element("tbody", {}, top.rows.map(line)));
    const block = page.element("section", { id: "top", "data-testid": "top", "aria-labelledby": "top-title" }, page.element("h2", { id: "top-title" }, "Best single designs"), page.element("p", { class: "hint" }, "The first of all feasible designs in one quantity, on the front or not: top.csv."), page.element("div", { class: "scroll tall" }, table));
    section.after(block);
  };
}
