// Columns of whole numbers, as documents have them: differences that add up to the values.

/** Tenths of a millimetre, and ten-thousandths, in 1. */
export const FINE = 1e-4;
/** Hundredths of a newton in 1 N. */
export const FORCE = 1e-2;

/** Adds the differences up, row by row; `scale` is what a whole number stands for. */
export function summed(column: readonly number[], width = 1, scale = 1): Float64Array {
  const values = new Float64Array(column.length);
  const sums = new Float64Array(width);
  for (let i = 0; i < column.length; i += 1) {
    const place = i % width;
    const sum = (sums[place] ?? 0) + (column[i] ?? 0);
    sums[place] = sum;
    values[i] = sum * scale;
  }
  return values;
}

/** The same where values may be missing: they become NaN, and the next differs from the last that was there. */
export function summedWithGaps(column: readonly (number | null)[], scale = 1): Float64Array {
  const values = new Float64Array(column.length);
  let sum = 0;
  column.forEach((difference, i) => {
    if (difference === null) values[i] = Number.NaN;
    else values[i] = (sum += difference) * scale;
  });
  return values;
}

/** The place of the last time that is not after `t`; −1 if there is none. */
export function lastAt(times: ArrayLike<number>, t: number): number {
  let low = 0;
  let high = times.length;
  while (low < high) {
    const middle = (low + high) >>> 1;
    if ((times[middle] ?? 0) <= t) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}

/** The place of the first time that is after `t`; the number of times if there is none. */
export function firstAfter(times: ArrayLike<number>, t: number): number {
  return lastAt(times, t) + 1;
}
