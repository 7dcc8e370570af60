// The section of what explains the feasible designs: a bar for every axis and quantity.
{
  const [WIDTH, HEIGHT] = [92, 14];
  let run = 0;

  const clamped = (share) => Math.max(0, Math.min(1, share));

  const bar = ({ share, half }, axis, column) => {
    if (Number.isNaN(share)) return page.element("td", { class: "muted" }, "–");
    const text = `${(100 * clamped(share)).toFixed(0)} %`;
    const svg = d3.create("svg").attr("class", "share").attr("width", WIDTH).attr("height", HEIGHT).attr("viewBox", `0 0 ${WIDTH} ${HEIGHT}`).attr("preserveAspectRatio", "none").attr("role", "img").attr("aria-label", `${axis} explains ${text} of ${column}`);
    svg.append("rect").attr("class", "track").attr("width", WIDTH).attr("height", HEIGHT);
    svg.append("rect").attr("class", "part").attr("width", WIDTH * clamped(share)).attr("height", HEIGHT);
    const [low, high] = [share - half, share + half].map((it) => 0.75 + (WIDTH - 1.5) * clamped(it));
    for (const part of ["halo", "whisker"]) svg.append("path").attr("class", part).attr("d", `M${low},${HEIGHT / 2}H${high}M${low},4v${HEIGHT - 8}M${high},4v${HEIGHT - 8}`);
    return page.element("td", { "data-share": share.toFixed(4), "data-of": `${axis} ${column}` }, svg.node(), page.element("span", { class: "bar-text" }, text, page.element("span", { class: "unit" }, ` ± ${(100 * half).toFixed(half < 0.0995 ? 1 : 0)}`)));
  };

  // Leads to what the study asked for itself, which the page has further down.
  const pointer = () => {
    const target = document.querySelector('#table-sensitivity, [data-figure^="sensitivity-"]');
    if (!target) return null;
    const go = () => {
      target.scrollIntoView({ block: "start" });
      target.setAttribute("tabindex", "-1");
      target.focus({ preventScroll: true });
    };
    return page.element("button", { type: "button", id: "to-sensitivity", class: "no-print", click: go }, "Show it");
  };

  const isOld = (section) => {
    if (section.dataset.old === "yes") return;
    section.dataset.old = "yes";
    section.querySelector(".hint")?.append(" This is of the study before the last change; it follows once nothing moves.");
  };

  const put = (...children) => {
    const section = page.byId("explained");
    const title = page.element("h2", { id: "explained-title" }, "Which axis explains what, over the feasible designs");
    section.hidden = false;
    section.dataset.old = "no";
    section.replaceChildren(title, ...children.filter(Boolean));
    if (section.querySelector("table")) page.saveButtons(title, "importance", () => section.querySelector("table"));
  };

  const table = ({ axes, columns }) => {
    const head = [page.element("th", { scope: "col" }, "axis"), columns.map(({ name, unit }) => page.element("th", { scope: "col" }, page.breakable(name), unit ? page.element("span", { class: "unit" }, ` ${page.unit(unit)}`) : null))];
    const levels = ({ levels: met, of, groups }) => {
      const all = of > met ? `${page.count(met)} of ${page.count(of)}` : page.count(met);
      return groups === 0 ? `${all} rows, too many for the sample` : groups < met ? `${all} values, in ${groups} groups` : `${all} levels`;
    };
    // The axis that explains most, summed over what is shown, comes first.
    const order = d3.sort(d3.range(axes.length), (a) => -d3.sum(columns, ({ shares }) => clamped(shares[a].share || 0)));
    const line = (a) => page.element("tr", {}, page.element("th", { scope: "row" }, page.breakable(axes[a].name), page.element("div", { class: "unit" }, levels(axes[a]))), columns.map(({ name, shares }) => bar(shares[a], axes[a].name, name)));
    return page.element("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": "Shares of the variance" }, page.element("table", { class: "explained" }, page.element("thead", {}, page.element("tr", {}, head)), page.element("tbody", {}, order.map(line))));
  };

  const whole = ({ rows, of }) => {
    if (rows === page.data.study.feasible) return `all ${page.count(rows)} feasible designs`;
    return `${rows < of ? `${page.count(rows)} of ` : ""}a sample of ${page.count(of)} feasible designs`;
  };

  const hint = (sample, found) =>
    page.element("p", { class: "hint" }, `Shares of the variance over ${whole(sample)} that an axis explains by itself (first order, between its levels, without what so many levels explain by chance). ±, and the line on each bar: the interval of 95 % from ${found.resamples} resamples (bootstrap, seed ${found.seed}). The rest comes from axes together. Feasible designs do not have every combination, so shares can add up to more than 100 %.`);

  // `old`: the sample is of the study before the last change.
  page.showExplained = async (old = false) => {
    const mine = ++run;
    const { data, front, feasible } = page;
    const section = page.byId("explained");
    if (!front || !front.objectives.length || (!feasible && data.kind === "live")) return (section.hidden = true);
    if (data.sensitivity_over === "design") return put(page.element("p", {}, "The study asked for this itself, over all designs: see “Which choice matters over the design” below. ", pointer()));
    if (!feasible && !front.rows) return (section.hidden = true);
    if (!feasible) return put(page.element("p", { class: "hint" }, "This result has no sample of the feasible designs. With ", page.element("code", {}, "sample = 2000"), " in [report] of the study, this page shows which axis explains each objective, and the sample behind the front."));
    if (feasible.rows < page.fewestFeasible) return put(page.element("p", { class: "hint" }, `There are ${page.count(feasible.rows)} feasible designs in the sample. That is too few to say: it takes ${page.fewestFeasible} at least.`));
    if (old) return isOld(section);
    const found = await page.importance(feasible, () => mine !== run);
    if (!found || mine !== run) return null;
    if (!found.axes.length || !found.columns.length) return put(page.element("p", { class: "hint" }, "Nothing varies over the feasible designs."));
    const further = data.sensitivity_over === "uncertainty" ? page.element("p", {}, "What the uncertain inputs do to one design is below. ", pointer()) : null;
    put(table(found), hint(feasible, found), further);
    page.timings.explained = performance.now();
    return null;
  };
}
