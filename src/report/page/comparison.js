// Printed and computed numbers, paper by paper, each with its reason; what was read differently, and what is missing.
{
  const comparison = (rows) => {
    const section = page.byId("comparison");
    section.hidden = false;
    const head = [["where", ""], ["what", ""], ["printed", ""], ["computed", ""], ["difference", "number"], ["verdict", ""], ["reason", "reason"]];
    const withUnit = (text, unit) => (unit && /\d/.test(text) && !text.includes(unit) ? `${text} ${unit}` : text);
    const line = (row) => {
      const cell = (text, kind) => page.element("td", { class: kind }, text ?? "");
      return page.element("tr", { class: `verdict-${(row.verdict || "").replace(/ /g, "-")}` }, cell(row.at, "muted"), page.element("th", { scope: "row" }, row.what), cell(withUnit(row.printed, row.unit), "printed"), cell(withUnit(row.computed, row.unit), "printed"), cell(row.difference, "number"), cell(row.verdict, "verdict"), cell(row.reason, "reason"));
    };
    const group = ([name, rows]) => page.element("tbody", {}, page.element("tr", { class: "group" }, page.element("th", { colspan: head.length, scope: "rowgroup" }, name)), rows.map(line));
    const heads = head.map(([name, kind]) => page.element("th", { scope: "col", class: kind }, name));
    const table = page.element("table", { class: "comparison" }, page.element("thead", {}, page.element("tr", {}, heads)), [...d3.group(rows, (row) => row.group)].map(group));
    section.append(page.element("h2", { id: "comparison-title" }, "Printed and computed"), page.element("div", { class: "scroll" }, table));
  };

  const list = ({ title, items }) => {
    const line = ({ group, at, text }) => page.element("tr", {}, page.element("td", { class: "muted" }, group), page.element("th", { scope: "row" }, at), page.element("td", { class: "reason" }, text));
    return page.element("section", { "aria-label": title }, page.element("h2", {}, title), page.element("div", { class: "scroll" }, page.element("table", { class: "comparison" }, page.element("tbody", {}, items.map(line)))));
  };

  page.startComparison = () => {
    const { comparison: rows, lists } = page.data;
    if (rows && rows.length) comparison(rows);
    page.byId("study").before(...(lists || []).filter(({ items }) => items.length).map(list));
  };
}
