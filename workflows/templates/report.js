"use strict";
// Sections become tabs, and figures are drawn when they are first seen. Without this script the page
// is one long document with still pictures, which is also what is printed.

const INK = "#1b2a38"; // drawn in the text colour of the page, as in the still pictures
const OPTIONS = { responsive: true, displaylogo: false, modeBarButtonsToRemove: ["sendChartToCloud"] };
const page = document.documentElement;
const sections = [...document.querySelectorAll("main > section")];
const tabs = [...document.querySelectorAll("nav a")];

function colour(name) {
  return getComputedStyle(page).getPropertyValue(name).trim();
}

function draw(figure) {
  const target = figure.querySelector(".plot");
  const ink = colour("--ink");
  const text = figure.querySelector("script").textContent.replaceAll(INK, ink);
  const plot = JSON.parse(text);
  plot.layout.font.color = ink;
  plot.layout.hoverlabel = { bgcolor: colour("--panel"), bordercolor: colour("--line"), font: { color: ink } };
  figure.classList.add("drawn");
  Plotly.newPlot(target, plot.data, plot.layout, OPTIONS)
    .catch((error) => {
      figure.classList.remove("drawn"); // the still picture stays
      console.error(error);
    });
}

const seen = new IntersectionObserver((entries) => {
  for (const entry of entries.filter((one) => one.isIntersecting)) {
    seen.unobserve(entry.target);
    draw(entry.target);
  }
}, { rootMargin: "200px" });

// The section that holds the element named by the address, or the first one.
function addressed() {
  const target = document.getElementById(decodeURIComponent(location.hash.slice(1)));
  return target?.closest("main > section") ?? sections[0];
}

function show() {
  const whole = location.hash === "#everything";
  const chosen = addressed();
  for (const section of sections) section.hidden = !whole && section !== chosen;
  for (const tab of tabs) {
    const target = tab.getAttribute("href");
    const isChosen = whole ? target === "#everything" : target === "#" + chosen.id;
    tab.setAttribute("aria-selected", String(isChosen));
  }
  if (location.hash && !whole && location.hash.slice(1) !== chosen.id) {
    document.getElementById(decodeURIComponent(location.hash.slice(1))).scrollIntoView();
  }
}

// On paper all sections are wanted; figures that were not drawn yet are there as still pictures.
window.addEventListener("beforeprint", () => sections.forEach((section) => { section.hidden = false; }));
window.addEventListener("afterprint", show);
window.addEventListener("hashchange", show);
tabs.at(-1)?.insertAdjacentHTML("afterend", '<a href="#everything">Everything</a>');
tabs.push(document.querySelector('nav a[href="#everything"]'));
tabs.forEach((tab) => tab.setAttribute("role", "tab"));
document.querySelector("nav").setAttribute("role", "tablist");
page.classList.add("scripted");
show();
document.querySelectorAll("figure.interactive").forEach((figure) => seen.observe(figure));
