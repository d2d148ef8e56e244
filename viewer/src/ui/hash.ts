// The address keeps what is looked at: `#run=tests.t002&with=tests.t005&t=13.170`.

export interface Address {
  run?: string;
  with?: string;
  t?: number;
  range?: [number, number];
  focus?: string;
}

const time = (text: string | null | undefined): number | undefined => {
  const t = Number(text || Number.NaN);
  return Number.isFinite(t) && t >= 0 ? t : undefined;
};

export function readAddress(hash: string): Address {
  const fields = new URLSearchParams(hash.replace(/^#/, ""));
  const address: Address = {};
  const run = fields.get("run");
  const beside = fields.get("with");
  const focus = fields.get("focus");
  const t = time(fields.get("t"));
  const [from, to] = (fields.get("range") ?? "").split("..").map(time);
  if (run) address.run = run;
  if (beside) address.with = beside;
  if (focus) address.focus = focus;
  if (t !== undefined) address.t = t;
  if (from !== undefined && to !== undefined && from < to) address.range = [from, to];
  return address;
}

export function writeAddress(address: Address): string {
  const part = (name: string, value: string | undefined) => (value === undefined ? [] : [`${name}=${encodeURIComponent(value)}`]);
  const shown = (t: number) => t.toFixed(3);
  return `#${[
    ...part("run", address.run),
    ...part("with", address.with),
    ...part("focus", address.focus),
    ...part("t", address.t === undefined ? undefined : shown(address.t)),
    ...part("range", address.range && address.range.map(shown).join("..")),
  ].join("&")}`;
}
