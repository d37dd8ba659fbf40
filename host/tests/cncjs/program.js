// The program that the senders stream: a spiral of short lines that ends at X3 Y4.

const LINES = 10_000;
const RADIUS_MM = 8;

/** @returns {string} 10,004 lines. */
export function spiral() {
  const lines = ["G21 G90 G54", "G1 F2400 X0 Y0"];
  for (let number = 0; number < LINES; number += 1) {
    const angle = number / 20;
    const radius = (number / LINES) * RADIUS_MM;
    const x = radius * Math.cos(angle);
    const y = radius * Math.sin(angle);
    lines.push(`G1 X${x.toFixed(3)} Y${y.toFixed(3)}`);
  }
  lines.push("G0 X3 Y4", "M2");
  return `${lines.join("\n")}\n`;
}
