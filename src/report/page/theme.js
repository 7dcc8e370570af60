// Light and dark theme, the width of the layout, and printing: always light, at the width of a sheet.
{
  const SHEET = 680; // px of a printed line on A4 and letter paper
  const SHEET_HEIGHT = 940;
  const system = window.matchMedia("(prefers-color-scheme: dark)");
  page.printing = false;

  page.dark = () => !page.printing && (page.state.theme ? page.state.theme === "dark" : system.matches);

  page.layoutWidth = (element) => {
    if (page.printing) return SHEET;
    const style = getComputedStyle(element);
    return element.clientWidth - parseFloat(style.paddingLeft) - parseFloat(style.paddingRight);
  };

  page.applyTheme = () => {
    document.documentElement.dataset.theme = page.dark() ? "dark" : "light";
    const button = page.byId("theme");
    if (button) button.textContent = page.dark() ? "Light" : "Dark";
    page.events.call("theme");
  };

  page.toggleTheme = () => {
    page.state.theme = page.dark() ? "light" : "dark";
    page.applyTheme();
  };

  const print = (on) => {
    if (page.printing === on) return;
    page.printing = on;
    // Paper shows the study's text, which is the whole question.
    const study = document.querySelector("#study details");
    if (study) [study.open, page.studyOpen] = on ? [true, study.open] : [page.studyOpen, false];
    document.documentElement.dataset.theme = page.dark() ? "dark" : "light";
    // As wide as on paper, so that what stands on the first sheet can be measured.
    document.documentElement.classList.toggle("on-paper", on);
    page.events.call("layout");
    page.events.call("theme");
  };

  // What is left of the first sheet below the top of an element.
  page.sheetLeft = (element) => SHEET_HEIGHT - (element.getBoundingClientRect().top - page.byId("main").getBoundingClientRect().top);

  page.startTheme = () => {
    system.addEventListener("change", () => page.state.theme || page.applyTheme());
    window.addEventListener("beforeprint", () => print(true));
    window.addEventListener("afterprint", () => print(false));
    let width = window.innerWidth;
    let waiting = 0;
    window.addEventListener("resize", () => {
      if (page.printing || window.innerWidth === width) return;
      width = window.innerWidth;
      clearTimeout(waiting);
      waiting = setTimeout(() => page.events.call("layout"), 120);
    });
  };
}
