// Recorded ports as CSV: one row for each time of any part. A cell is empty if its part has no sample then.
// Pure.

export interface Column {
  name: string;
  times: readonly number[]; // growing, s
  values: readonly (number | null)[];
}

export function toCsv(columns: readonly Column[]): string {
  const times = [...new Set(columns.flatMap((column) => [...column.times]))].sort((a, b) => a - b);
  const at = columns.map(() => 0);
  const lines = [["time [s]", ...columns.map(({ name }) => quoted(name))].join(",")];
  for (const time of times) {
    const cells = columns.map((column, i) => {
      if (column.times[at[i]!] !== time) return "";
      const value = column.values[at[i]!++];
      return value === null || value === undefined || Number.isNaN(value) ? "" : String(Number(value.toPrecision(9)));
    });
    lines.push([Number(time.toFixed(9)), ...cells].join(","));
  }
  return `${lines.join("\r\n")}\r\n`;
}

function quoted(text: string): string {
  return /[",\r\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}
