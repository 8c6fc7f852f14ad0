// The workbench's part of the page; viser runs it in every browser that comes, after `const content = …`.
// It holds no state of the document and sends nothing: what it does concerns this browser alone.

const SEEN = "fuzzy-workbench-tour"; // localStorage: the tour was finished or dismissed in this browser
const FONT = "14px/1.5 Inter,system-ui,-apple-system,'Segoe UI',sans-serif";
const DARK = "background:#1f2227;color:#dfe3e8;border:1px solid #4a515b;border-radius:8px";
const BUTTON = "font:inherit;padding:4px 12px;border-radius:4px;border:1px solid #4a515b;cursor:pointer;color:#dfe3e8";

window.fuzzyWorkbench?.remove(); // of a server that has ended since
const ended = new AbortController();
const signal = ended.signal;

function element(tag, style = "", text = "", ...children) {
  const made = document.createElement(tag);
  made.style.cssText = style;
  made.textContent = text;
  made.append(...children);
  return made;
}

function button(label, act, style = "") {
  const made = element("button", `${BUTTON};background:#2d3138;${style}`, label);
  made.type = "button";
  made.addEventListener("click", act);
  return made;
}

// ---------------------------------------------------------------------------------------------- viser's elements

function tabOf(name) {
  return [...document.querySelectorAll("[role=tab]")].find((tab) => tab.textContent.trim() === name);
}

// The docked panel that holds a tab, or whose header says `name`; nothing in a narrow window, which has no docks.
function panelOf(name) {
  const header = [...document.querySelectorAll("[data-dock-unmergeable-header]")];
  const place = tabOf(name) ?? header.find((one) => one.textContent.trim().startsWith(name));
  return place?.closest("[data-dock-group]") ?? null;
}

// A docked tab listens to pointers and to keys, a tab of a narrow window to clicks.
function showTab(name) {
  const tab = tabOf(name);
  if (!tab) return;
  if (tab.closest("[data-dock-group]")) {
    tab.dispatchEvent(new KeyboardEvent("keydown", { key: "Enter", bubbles: true }));
  } else {
    tab.click();
  }
}

// A scroll bar has the margin beside the widgets to itself, and a long name ends within its panel.
const fitting = element("style", "", `
  .mantine-ScrollArea-scrollbar[data-orientation="vertical"] { width: 7px !important; padding: 1px !important; }
  .mantine-Flex-root > .mantine-Button-root .mantine-Button-label { max-width: 17em; }
`);

// Viser's sheet at the bottom of a narrow window is a column at its right that covers the scene; here it is as wide as
// the window and leaves the upper half to the scene.
const narrow = element("style", "", `@media (max-width: 36em) {
  div[style*="max-height: 60%"][style*="position: fixed"] { width: 100% !important; max-height: 50% !important; }
  div[style*="max-height: 60%"][style*="position: fixed"] div[style*="width: 20em"] { width: 100vw !important; }
}`);
document.head.append(fitting, narrow);

const isWritten = (target) => target.isContentEditable || /^(INPUT|TEXTAREA|SELECT)$/.test(target.tagName ?? "");

// ---------------------------------------------------------------------------------------------------------- keys

document.addEventListener(
  "keydown",
  (event) => {
    if (event.key === "?" && !isWritten(event.target) && !event.ctrlKey && !event.metaKey) {
      event.preventDefault();
      help();
      return;
    }
    if (event.key === "Escape" && tourCard && !document.querySelector("dialog[open]")) endTour();
    // Viser ignores hotkeys in every field. In a list that was just chosen from there is nothing else to undo,
    // and Ctrl+S means this document in any field, rather than the browser's own "save page".
    const letter = (event.key ?? "").toLowerCase();
    if (!event.isTrusted || !(event.ctrlKey || event.metaKey) || event.altKey || !isWritten(event.target)) return;
    if (letter === "s" || (letter === "z" && event.target.getAttribute("aria-haspopup") === "listbox")) {
      event.preventDefault();
      event.stopImmediatePropagation();
      event.target.blur(); // what was typed counts
      const { key, code, ctrlKey, metaKey, shiftKey } = event;
      const again = { key, code, ctrlKey, metaKey, shiftKey, bubbles: true, cancelable: true };
      setTimeout(() => document.body.dispatchEvent(new KeyboardEvent("keydown", again)), 100);
    }
  },
  { capture: true, signal },
);

// ---------------------------------------------------------------------------------------------------------- help

let helpWindow = null;

function help() {
  if (helpWindow) return;
  const section = (title, rows) => {
    const table = element("table", "border-collapse:collapse;width:100%");
    for (const [name, meaning] of rows) {
      const head = element("th", "text-align:left;vertical-align:top;font-weight:600;padding:2px 12px 2px 0", name);
      head.style.width = "10.5em";
      table.append(element("tr", "", "", head, element("td", "padding:2px 0;vertical-align:top;color:#b9c0c9", meaning)));
    }
    return element("section", "", "", element("h3", "font-size:15px;margin:12px 0 4px;color:#7fb0ff", title), table);
  };
  const columns = element("div", "display:grid;grid-template-columns:repeat(auto-fit,minmax(300px,1fr));gap:0 32px");
  const left = element("div", "", "", section("Keys", content.keys), section("Mouse", content.gestures));
  columns.append(left, element("div", "", "", section("Panels", content.panels)));
  const close = () => helpWindow?.close();
  const tour = button("Show the tour", () => (close(), startTour()));
  const done = button("Close", close, "background:#2f6fd6;border-color:#2f6fd6");
  done.autofocus = true;
  const foot = element("div", "display:flex;gap:8px;justify-content:flex-end;margin-top:14px", "", tour, done);
  helpWindow = element("dialog", `${DARK};font:${FONT};font-size:13px;padding:16px 22px;max-width:960px;width:92vw`);
  helpWindow.setAttribute("aria-label", "Help");
  helpWindow.append(element("h2", "font-size:18px;margin:0", "Fuzzy arm workbench"), columns, foot);
  helpWindow.addEventListener("click", (event) => event.target === helpWindow && close()); // beside it
  helpWindow.addEventListener("keydown", (event) => event.stopPropagation()); // no hotkeys meanwhile
  helpWindow.addEventListener("close", () => (helpWindow.remove(), (helpWindow = null)));
  document.body.append(helpWindow);
  helpWindow.showModal();
}

// ---------------------------------------------------------------------------------------------------------- tour

let tourCard = null;
let tourStep = 0;
const frame = element(
  "div",
  "position:fixed;z-index:89;pointer-events:none;border:2px solid #ffd75e;border-radius:6px;display:none",
);
frame.id = "fw-tour-frame";

function startTour() {
  endTour();
  tourStep = 0;
  tourCard = element("div", `position:fixed;z-index:90;${DARK};font:${FONT};padding:12px 16px`);
  tourCard.id = "fw-tour";
  tourCard.setAttribute("role", "region");
  tourCard.setAttribute("aria-label", "Tour");
  document.body.append(frame, tourCard);
  showStep();
}

function showStep() {
  const { title, text, panel } = content.tour[tourStep];
  const last = tourStep === content.tour.length - 1;
  if (panel) showTab(panel);
  const move = (by) => ((tourStep += by), showStep());
  const count = element("span", "color:#8b949e;margin-right:auto", `${tourStep + 1} of ${content.tour.length}`);
  const foot = element("div", "display:flex;gap:8px;align-items:center;margin-top:8px", "", count);
  if (!last) foot.append(button("Skip", endTour, "border-color:transparent;background:none"));
  if (tourStep > 0) foot.append(button("Back", () => move(-1)));
  foot.append(button(last ? "Done" : "Next", () => (last ? endTour() : move(1)), "background:#2f6fd6;border-color:#2f6fd6"));
  tourCard.replaceChildren(element("b", "font-size:15px", title), element("div", "margin-top:2px", text), foot);
  place();
}

// The card lies over the scene and over no widget; the frame lets every click through.
function place() {
  if (!tourCard) return;
  const scene = document.querySelector("canvas")?.getBoundingClientRect();
  const left = scene?.left ?? 0;
  const width = scene?.width || window.innerWidth;
  const wide = Math.min(420, width - 24);
  tourCard.style.boxSizing = "border-box";
  tourCard.style.width = `${wide}px`;
  tourCard.style.left = `${left + (width - wide) / 2}px`;
  tourCard.style.top = "12px"; // there is little of the scene, and in a narrow window the panels are below
  const name = content.tour[tourStep].panel;
  const box = name ? panelOf(name)?.getBoundingClientRect() : null;
  frame.style.display = box ? "block" : "none";
  if (!box) return;
  Object.assign(frame.style, {
    left: `${box.left}px`,
    top: `${box.top}px`,
    width: `${box.width - 4}px`,
    height: `${box.height - 4}px`,
  });
}

function endTour() {
  if (!tourCard) return;
  tourCard.remove();
  frame.remove();
  tourCard = null;
  try {
    localStorage.setItem(SEEN, "seen");
  } catch {
    // A browser that keeps nothing shows the tour at its next visit, too.
  }
}

window.addEventListener("resize", () => requestAnimationFrame(place), { signal });

function isFirstVisit() {
  try {
    return localStorage.getItem(SEEN) === null;
  } catch {
    return true;
  }
}

function tourAtFirstVisit() {
  if (signal.aborted || !isFirstVisit()) return;
  if (document.querySelector("[role=tab], [role=slider]")) startTour();
  else setTimeout(tourAtFirstVisit, 300); // the panels are not there yet
}

window.fuzzyWorkbench = {
  showTab,
  help,
  tour: startTour,
  remove() {
    ended.abort();
    helpWindow?.close();
    tourCard?.remove();
    frame.remove();
    fitting.remove();
    narrow.remove();
  },
};
tourAtFirstVisit();
