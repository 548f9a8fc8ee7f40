/** A plot as a file: its picture with the colours that it has on the screen, its curves as numbers. */

import { csv } from "../model/table";
import { offer } from "./choose";

interface Curve {
  name: string;
  x: readonly (number | null)[];
  y: readonly (number | null)[];
}

const NAMESPACE = "http://www.w3.org/2000/svg";
const KEPT = ["fill", "stroke", "stroke-width", "stroke-dasharray", "font-size", "font-family"] as const;
const LINE = 14;

const fileName = (title: string, suffix: string): string =>
  `${title.replaceAll(/\W+/g, "_").slice(0, 60) || "plot"}.${suffix}`;

function withStyle(original: Element, copy: Element): void {
  const style = window.getComputedStyle(original);
  for (const key of KEPT) copy.setAttribute(key, style.getPropertyValue(key));
  [...original.children].forEach((child, i) => {
    const twin = copy.children[i];
    if (twin !== undefined) withStyle(child, twin);
  });
}

function text(at: { x: number; y: number }, words: string, colour: string): SVGTextElement {
  const element = window.document.createElementNS(NAMESPACE, "text");
  const attributes = { x: at.x, y: at.y, fill: colour, "font-size": 11, "font-family": "sans-serif" };
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, String(value));
  element.textContent = words;
  return element;
}

/** The picture of a plot, with the names of its curves in their colours below. */
export function savePlot(svg: SVGSVGElement, title: string, curves: readonly Curve[]): void {
  const copy = svg.cloneNode(true) as SVGSVGElement;
  withStyle(svg, copy);
  const { width, height } = svg.viewBox.baseVal;
  const lines = [...copy.querySelectorAll(".series")].map((line) => line.getAttribute("stroke") ?? "black");
  curves.forEach(({ name }, i) => copy.append(text({ x: 56, y: height + (i + 1) * LINE }, name, lines[i] ?? "black")));
  const whole = height + (curves.length + 1) * LINE;
  const size = { xmlns: NAMESPACE, viewBox: `0 0 ${width} ${whole}`, width, height: whole };
  for (const [key, value] of Object.entries(size)) copy.setAttribute(key, String(value));
  offer(new Blob([copy.outerHTML], { type: "image/svg+xml" }), fileName(title, "svg"));
}

/** The curves of a plot as columns, where they are over the same points; else each point with its curve's name. */
export function saveCurves(title: string, xTitle: string, curves: readonly Curve[]): void {
  const [first] = curves;
  const isCommon = curves.every(
    ({ x }) => x === first?.x || (x.length === first?.x.length && x.every((at, i) => at === first.x[i])),
  );
  const table = isCommon
    ? csv(
        [xTitle, ...curves.map(({ name }) => name)],
        (first?.x ?? []).map((at, i) => [at, ...curves.map(({ y }) => y[i] ?? null)]),
      )
    : csv(
        ["curve", xTitle, "value"],
        curves.flatMap(({ name, x, y }) => x.map((at, i) => [name, at, y[i] ?? null])),
      );
  offer(new Blob([table], { type: "text/csv" }), fileName(title, "csv"));
}
