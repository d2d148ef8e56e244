// Signs of the buttons, drawn: fonts do not all have them.

const NAMESPACE = "http://www.w3.org/2000/svg";

const PATHS = {
  play: "M4 2.5v11l9-5.5z",
  pause: "M4 2.5h3v11h-3zM9 2.5h3v11h-3z",
  next: "M3 2.5v11l7-5.5zM11 2.5h2v11h-2z",
  previous: "M13 2.5v11l-7-5.5zM3 2.5h2v11h-2z",
  nextViolation: "M2 3v10l5-5zM11.5 3.5l4 4.5-4 4.5-4-4.5z",
  previousViolation: "M14 3v10l-5-5zM4.5 3.5l4 4.5-4 4.5-4-4.5z",
  theme: "M8 1.5a6.5 6.5 0 1 0 0 13zM8 1.5a6.5 6.5 0 0 1 0 13v-1.4a5.1 5.1 0 0 0 0-10.2z",
} as const;

export type IconName = keyof typeof PATHS;

export function icon(name: IconName): SVGSVGElement {
  const svg = document.createElementNS(NAMESPACE, "svg");
  svg.setAttribute("viewBox", "0 0 16 16");
  svg.setAttribute("aria-hidden", "true");
  svg.setAttribute("class", "sign");
  const path = document.createElementNS(NAMESPACE, "path");
  path.setAttribute("d", PATHS[name]);
  svg.append(path);
  return svg;
}
