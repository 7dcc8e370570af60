// The page of a study in work.
{
  // What a button did stands in front of the command until the study changes; the line above is the engine's, which may say more at any moment.
  const sayDone = (text, kind = "done") => {
    const done = page.byId("done");
    done.textContent = text;
    done.dataset.kind = kind;
  };
  // What is shown may still be of the study before: the engine is asked for the study as it is changed now, and says why there is none.
  const withStudy = (failed, use) => async () => {
    const set = page.changeList();
    const sayOfIt = (text, kind) => String(page.changeList()) === String(set) && sayDone(text, kind);
    sayDone("");
    try {
      sayOfIt(await use(await page.askOnce("/study", { set })));
    } catch (error) {
      sayOfIt(`${failed}: ${error.message}`, "error");
    }
  };
  const save = withStudy("not saved", ({ study }) => {
    const name = `${study.file.split(/[\\/]/).pop().replace(/\.toml$/, "")}-explored.toml`;
    page.download(name, "application/toml", study.saved);
    return `saved as ${name}`;
  });
  const copyCommand = withStudy("not copied", async ({ command }) => {
    page.byId("command").textContent = command;
    return (await page.copyText(command)) ? "command copied" : "select the command to copy it";
  });

  // A command that opens this very view again. Changes made on the page are part of the view: pins name theirs in the same way. What the
  // program was started with stays as --set.
  const copyView = withStudy("not copied", async () => {
    const { evaluate } = await page.askOnce("/study", { set: [] });
    const explore = evaluate.replace(" eval ", " explore ").replace(" --design {design}", "");
    const view = page.viewText().replace(/["'!`$\\]/g, (sign) => `%${sign.charCodeAt(0).toString(16)}`);
    const command = view ? `${explore} --view "${view}"` : explore;
    page.byId("command").textContent = command;
    return (await page.copyText(command)) ? "command of this view copied" : "select the command to copy it";
  });

  const bar = () => {
    const live = page.byId("live");
    live.hidden = false;
    const ghost = page.element("input", { type: "checkbox", id: "ghost", checked: true, change: (event) => page.showGhost(event.target.checked) });
    const copy = page.element("button", { type: "button", class: "no-print", "data-testid": "copy-command", title: "The sweep of this study", click: copyCommand }, "Copy command");
    const view = page.element("button", { type: "button", class: "no-print", "data-testid": "copy-view", title: "A command that opens this very view again, with ranges, pins and weights", click: copyView }, "Copy view");
    live.replaceChildren(
      page.element("p", { id: "live-text", role: "status", "aria-live": "polite" }, "asking the engine …"),
      page.element("div", { class: "controls no-print" }, page.element("label", {}, ghost, " old front ", page.element("span", { class: "ghost-dot", "aria-hidden": "true" })), copy, view, page.element("button", { type: "button", id: "save", "data-testid": "save", click: save }, "Save as study")),
      page.element("div", { class: "command-line" }, page.element("span", { id: "done", class: "no-print", role: "status" }), page.element("code", { id: "command", "data-testid": "command", tabindex: 0 })),
    );
  };

  page.startLive = async () => {
    // Without a front it reads the theme only.
    page.readAddress();
    page.startTheme();
    document.documentElement.dataset.theme = page.dark() ? "dark" : "light";
    page.data = { ...page.data, ...(await page.askOnce("/start", {})) };
    document.title = `${page.data.title}: beltspace explore`;
    page.data.study.feasible = null;
    page.startOverview();
    bar();
    page.events.on("changes.done", () => sayDone(""));
    const given = page.changesOfAddress();
    page.beginChanges(given);
    page.startControls();
    page.startAnswers();
    page.timings.firstPaint = performance.now();
  };
}
