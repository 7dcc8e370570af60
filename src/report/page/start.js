// Builds the page: first the plots that can be brushed, then, after the first frame, the rest.
{
  const afterFrame = () => new Promise((done) => requestAnimationFrame(() => setTimeout(done)));

  const start = async () => {
    await page.decode();
    if (page.data.kind === "live") return page.startLive();
    const open = page.readAddress();
    page.startTheme();
    document.documentElement.dataset.theme = page.dark() ? "dark" : "light";
    page.startOverview();
    const { front } = page;
    if (front && front.rows) {
      page.applySelection();
      page.startBar();
      page.startPins();
      page.startOthers();
      page.startMatrix();
      page.startStrip();
      page.startReadout();
      page.startParallel();
    }
    page.startTally();
    await afterFrame();
    page.timings.firstPaint = performance.now();
    if (front && front.rows) {
      page.startChooser();
      page.startTable();
      page.startKneeSlices();
    }
    // Lists and maps open cards, with a front or without.
    page.startCard();
    page.startWeigh();
    page.startAddress();
    page.startLists();
    page.startHistograms();
    page.startComparison();
    page.startFigures();
    page.startStudy();
    await page.startMaps();
    page.showExplained();
    open?.();
    page.timings.complete = performance.now();
  };

  document.querySelector("[data-skip]").addEventListener("click", (event) => {
    event.preventDefault();
    // The first of these that the page has. #main contains the others.
    const target = ["#splom [tabindex]", "#figures:not([hidden])", "#main"].map((it) => document.querySelector(it)).find(Boolean);
    if (!target.hasAttribute("tabindex")) target.setAttribute("tabindex", "-1");
    target.focus();
  });

  const columns = () => Object.fromEntries((page.front ? page.front.columns : []).map((column) => [column.name, column.values]));

  // The page for scripts and tests: the same functions that brushes, buttons and keys call.
  window.beltspace = {
    get data() {
      return page.data;
    },
    get columns() {
      return columns();
    },
    get state() {
      return page.state;
    },
    timings: page.timings,
    selected: () => page.selected(),
    brushAxis: (name, range) => page.brushAxis(name, range),
    brushCell: (x, y, xRange, yRange) => page.brushCell(x, y, xRange, yRange),
    clear: () => page.clearBrushes(),
    chooseColumns: (which, names) => page.chooseColumns(which, names),
    setColour: (name) => page.setColour(name),
    moveAxis: (name, to) => page.moveAxis(name, to),
    invertAxis: (name) => page.invertAxis(name),
    openCard: (row) => page.openCard(row),
    closeCard: () => page.closeCard(),
    csv: () => page.selectedCsv(),
    change: (parts) => page.change(parts),
    page,
  };
  window.beltspace.ready = start().catch((error) => {
    const message = `This page could not be shown: ${error.message}. The same results are in the files beside it.`;
    page.byId("main").prepend(page.element("p", { class: "notice" }, message));
    throw error;
  });
}
