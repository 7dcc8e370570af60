// The head of the page: the study, its outcome, how long it took; and at the end the text of the study.
{
  const fact = (label, value, testid, title) =>
    value === null || value === undefined || value === "" ? null : page.element("div", { class: "fact", "data-testid": testid, title }, page.element("dt", {}, label), page.element("dd", {}, value));

  const runText = (run) => {
    const parts = [page.seconds(run.seconds), run.engine === "cpu" ? `CPU, ${run.threads} threads` : run.device && run.device.adapter ? `${run.engine}: ${run.device.adapter}` : run.engine];
    return parts.join(", ");
  };

  // The ideal and the knee, or the first design by weights, side by side, one line for each objective.
  const objectives = () => {
    const { front } = page;
    const ideal = front.ideal || {};
    const chosen = page.chosenRow() ?? null;
    const word = page.isWeighed() ? "first" : "knee";
    const line = ({ column, goal, of }) => {
      const knee = chosen === null ? null : column.values[chosen];
      const value = (number, text) => page.element("td", { class: "number", title: page.full(number) }, text);
      return page.element(
        "tr",
        {},
        page.element("th", { scope: "row", title: column.doc }, of),
        page.element("td", {}, page.unit(column.unit)),
        page.element("td", {}, goal),
        value(ideal[of], page.short(ideal[of])),
        chosen === null ? null : value(knee, page.valueText(column, chosen)),
      );
    };
    const head = ["objective", "unit", "goal", "ideal", chosen === null ? null : word].filter(Boolean);
    const title = { ideal: "the best value of each objective; no single design reaches all of them", knee: "the design nearest to the ideal, with each objective scaled to its range on the front", first: "the first design by the weights and wished values" };
    return page.element(
      "table",
      { class: "objectives", "data-testid": "objectives" },
      page.element("thead", {}, page.element("tr", {}, head.map((name) => page.element("th", { scope: "col", class: title[name] ? "number" : "", title: title[name] }, name)))),
      page.element("tbody", {}, front.objectives.map(line)),
    );
  };

  // What is asked: bounds, and what the drive must survive.
  const question = (withGoals) => {
    const { constraints, inputs, drawn, objectives: asked } = page.data;
    const bound = ({ of, bounds, unit }) => page.element("tr", {}, page.element("th", { scope: "row" }, page.breakable(of)), page.element("td", {}, page.grouped(bounds) + (unit ? ` ${page.unit(unit)}` : "")));
    const over = (input) => page.element("tr", {}, page.element("th", { scope: "row", title: input.doc }, page.breakable(input.name)), page.element("td", { title: input.drawn }, `${page.grouped(input.over)}${input.unit && !input.over.startsWith("times") ? ` ${page.unit(input.unit)}` : ""}`));
    const varied = (inputs || []).filter((input) => ["operation", "uncertainty"].includes(input.role));
    const body = (title, lines) => (lines.length ? page.element("table", { class: "question" }, page.element("tbody", {}, page.element("tr", { class: "group" }, page.element("th", { colspan: 2, scope: "rowgroup" }, title)), lines)) : null);
    const laws = (inputs || []).filter((input) => input.role === "drawn");
    const goal = ({ of, goal }) => page.element("tr", {}, page.element("th", { scope: "row" }, page.breakable(of)), page.element("td", {}, goal === "min" ? "as low as possible" : "as high as possible"));
    const parts = [
      withGoals ? body("asked for", (asked || []).map(goal)) : null,
      body("must hold", (constraints || []).map(bound)),
      drawn ? body("every draw must keep", drawn.constraints.map(bound)) : null,
      body(drawn ? "in every operating case of" : "in every scenario of", varied.map(over)),
      body("drawn from a distribution", laws.map(over)),
    ].filter(Boolean);
    return parts.length ? page.element("div", { class: "questions", "data-testid": "question" }, parts) : null;
  };

  const goals = () => {
    const chosen = page.chosenRow() ?? null;
    const word = page.isWeighed() ? "the first" : "the knee";
    const open = chosen === null ? null : page.element("button", { type: "button", id: "open-knee", "data-testid": "open-knee", class: "primary", click: () => page.openCard(page.chosenRow()) }, `Open ${word}: design ${page.full(page.designOf(chosen))}`);
    return page.element("div", { class: "goals" }, [objectives(), question(false), open].filter(Boolean));
  };
  page.showGoals = () => page.keepFocus(page.byId("overview"), () => page.byId("overview").querySelector(".goals")?.replaceWith(goals()));

  page.startOverview = () => {
    const { data, front } = page;
    const { study, model, run } = data;
    const theme = page.element("button", { type: "button", id: "theme", "data-testid": "theme", "aria-label": "Light or dark page", click: page.toggleTheme }, page.dark() ? "Light" : "Dark");
    const facts = [];
    if (study) {
      facts.push(fact("designs", page.count(study.designs), "designs"));
      if (data.drawn) facts.push(fact(data.drawn.cases > 1 ? `draws each, in ${page.count(data.drawn.cases)} operating cases` : "draws each", page.count(data.drawn.draws), "draws"));
      if (!data.drawn || study.scenarios > 1) facts.push(fact("scenarios each", page.count(study.scenarios), "scenarios"));
      const known = study.feasible !== null && study.feasible !== undefined;
      facts.push(fact("feasible in all", known ? `${page.count(study.feasible)} (${page.percent(study.feasible, study.designs)})` : "…", "feasible", known ? null : "counted once nothing is changed for a moment"));
    }
    if (front) facts.push(fact(front.of > front.rows ? `shown, of ${page.count(front.of)} on the Pareto front` : "on the Pareto front", page.count(front.rows), "front-size"));
    if (run) facts.push(fact("computed in", runText(run), "run", `${run.platform || ""} ${run.origin || ""}`.trim()));
    if (data.kind !== "live") facts.push(fact("program", data.program, "program"));
    const parts = [
      page.element("div", { class: "title-line" }, page.element("h1", {}, data.title), theme),
      model && !model.limits ? page.element("p", { class: "model" }, page.element("strong", {}, model.name), `: ${model.summary}.`) : "",
      model && model.limits ? page.element("details", { class: "limits" }, page.element("summary", {}, page.element("strong", {}, model.name), `: ${model.summary}. `, page.element("span", { class: "muted" }, "Its limits")), page.element("p", {}, model.limits), model.source ? page.element("p", { class: "source" }, `Source: ${model.source}.`) : null) : "",
      page.element("dl", { class: "facts" }, facts.filter(Boolean)),
      data.feasible_file ? page.element("p", { class: "hint", "data-testid": "feasible-file" }, `All feasible designs are in ${data.feasible_file} beside this page's result.`) : "",
      data.sensitivity ? page.element("p", { class: "notice" }, `Which input matters: ${data.sensitivity}.`) : "",
      (data.notes || []).map((note) => page.element("p", { class: "notice" }, note)),
      front && front.rows && front.objectives.length ? goals() : page.element("div", { class: "goals" }, [question(true)].filter(Boolean)),
    ];
    page.keepOpen(page.byId("overview"), () => page.byId("overview").replaceChildren(...parts.flat().filter((part) => part !== "")));
  };

  page.startStudy = () => {
    const { study, inputs } = page.data;
    if (!study || !study.text) return;
    const section = page.byId("study");
    section.hidden = false;
    const parts = [
      page.element("h2", { id: "study-title" }, "Study"),
      page.element("details", {}, page.element("summary", {}, `${study.file || "study.toml"}`, study.hash ? page.element("span", { class: "muted" }, ` hash ${study.hash.slice(0, 16)}…`) : ""), page.element("pre", { tabindex: 0 }, study.text)),
      inputs && inputs.length ? page.element("details", {}, page.element("summary", {}, "Inputs of the model"), inputTable(inputs)) : "",
    ];
    page.keepOpen(section, () => section.replaceChildren(...parts));
  };

  const inputTable = (inputs) => {
    const line = (input) => page.element("tr", {}, [input.name, input.symbol || "", input.role, input.role === "fixed" ? page.short(input.value) : page.grouped(input.over || ""), page.unit(input.unit), input.doc || ""].map((text, i) => page.element("td", { class: i === 3 ? "number" : "" }, text)));
    const head = ["input", "symbol", "role", "value", "unit", "meaning"].map((name) => page.element("th", { scope: "col" }, name));
    return page.element("div", { class: "scroll" }, page.element("table", { class: "inputs" }, page.element("thead", {}, page.element("tr", {}, head)), page.element("tbody", {}, inputs.map(line))));
  };
}
