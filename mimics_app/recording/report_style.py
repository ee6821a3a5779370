"""The style sheet of a report: light and dark, on paper, and colours that differ in lightness as well as in hue."""

from __future__ import annotations

__all__ = ["STYLE"]

STYLE = """
:root { color-scheme: light dark; --paper: #ffffff; --card: #f5f7fa; --ink: #1a2230; --soft: #566173; --rule: #d5dbe4;
  --robot: #1559c9; --bisector: #c62828; --wall: #1f8a3b; --second: #b45f06; --third: #6a3fb5; --contact: #7a3b00;
  --touch: #e8590c33; --driven: #8894a733; --good: #1f7a3b; --warn: #9a5b00; --bad: #b3261e; }
@media (prefers-color-scheme: dark) { :root { --paper: #12161d; --card: #1b212b; --ink: #e7ebf2; --soft: #a3aec0;
  --rule: #343d4b; --robot: #74a9ff; --bisector: #ff7b72; --wall: #56d37b; --second: #f0a04b; --third: #c19bff;
  --contact: #ffcf8a; --touch: #ff8a3d3d; --driven: #a3aec02e; --good: #56d37b; --warn: #f0b355; --bad: #ff8a80; } }
@media print { :root { color-scheme: light; --paper: #ffffff; --card: #f5f7fa; --ink: #1a2230; --soft: #566173;
  --rule: #d5dbe4; --robot: #1559c9; --bisector: #c62828; --wall: #1f8a3b; --second: #b45f06; --third: #6a3fb5;
  --contact: #7a3b00; --touch: #e8590c33; --driven: #8894a733; --good: #1f7a3b; --warn: #9a5b00; --bad: #b3261e; }
  main { max-width: none; padding: 0; } table { font-size: 10px; } th, td { padding: 3px 4px; }
  figure, tr, .cards > div { break-inside: avoid; } h2 { break-after: avoid; }
  * { print-color-adjust: exact; } }
* { box-sizing: border-box; }
body { margin: 0; background: var(--paper); color: var(--ink); font: 15px/1.5 system-ui, "Segoe UI", sans-serif; }
main { max-width: 1120px; margin: 0 auto; padding: 32px 28px 64px; }
h1 { font-size: 28px; line-height: 1.2; margin: 0 0 4px; letter-spacing: -0.01em; }
h2 { font-size: 20px; margin: 44px 0 12px; padding-top: 14px; border-top: 1px solid var(--rule); }
h3 { font-size: 16px; margin: 26px 0 8px; }
p { margin: 6px 0 12px; max-width: 76ch; } .soft { color: var(--soft); }
.badge { display: inline-block; padding: 1px 10px; border-radius: 999px; border: 1px solid currentColor;
  font-size: 13px; font-weight: 600; vertical-align: middle; margin-left: 10px; letter-spacing: 0; }
.good { color: var(--good); } .warn { color: var(--warn); } .bad { color: var(--bad); }
.cards { display: grid; grid-template-columns: repeat(auto-fit, minmax(190px, 1fr)); gap: 10px; margin: 22px 0 6px; }
.cards > div { background: var(--card); border: 1px solid var(--rule); border-radius: 10px; padding: 10px 14px; }
.cards b { display: block; font-size: 22px; line-height: 1.25; font-variant-numeric: tabular-nums; }
.cards span { color: var(--soft); font-size: 13px; }
.note { border-left: 4px solid var(--warn); background: var(--card); padding: 8px 14px; border-radius: 0 8px 8px 0; }
.note ul { margin: 4px 0; padding-left: 20px; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; width: 100%; font-size: 13px; font-variant-numeric: tabular-nums; }
th, td { padding: 4px 6px; border-bottom: 1px solid var(--rule); text-align: left; vertical-align: top; }
th { color: var(--soft); font-weight: 600; line-height: 1.3; } td.number, th.number { text-align: right; }
.keys td { overflow-wrap: anywhere; } .keys td:first-child { width: 34%; } td.number { white-space: nowrap; }
details { margin: 10px 0; } summary { cursor: pointer; font-weight: 600; padding: 6px 0; }
code { font: 13px ui-monospace, "DejaVu Sans Mono", monospace; overflow-wrap: anywhere; }
pre { font: 12px/1.4 ui-monospace, "DejaVu Sans Mono", monospace; white-space: pre-wrap; overflow-wrap: anywhere; }
figure { margin: 8px 0 18px; } figure > svg { width: 100%; height: auto; display: block; }
.legend { display: flex; flex-wrap: wrap; gap: 4px 18px; padding-left: 62px; color: var(--soft); font-size: 13px; }
.legend span { display: inline-flex; align-items: center; gap: 6px; } .swatch { width: 26px; height: 12px; }
svg text { fill: var(--soft); font: 12px system-ui, "Segoe UI", sans-serif; }
.grid { stroke: var(--rule); stroke-width: 1; fill: none; } .frame { fill: none; stroke: var(--soft); }
.line { fill: none; stroke: var(--ink); stroke-width: 1.5; stroke-linejoin: round; }
.line.robot { stroke: var(--robot); stroke-width: 1.8; } .line.bisector { stroke: var(--bisector); stroke-width: 1.6;
  stroke-dasharray: 7 4; } .line.wall { stroke: var(--wall); stroke-width: 2.2; }
.line.carried { stroke: var(--second); stroke-width: 2.2; }
.line.felt { stroke: var(--robot); } .line.measured { stroke: var(--second); }
.line.tangent { stroke: var(--robot); } .line.normal { stroke: var(--second); } .line.binormal { stroke: var(--third); }
.line.margin { stroke: var(--wall); } .line.energy { stroke: var(--second); }
svg text.name { fill: var(--ink); font-weight: 600; }
.line.mark { stroke: var(--bad); stroke-dasharray: 3 3; }
.point.contact { fill: var(--paper); stroke: var(--contact); stroke-width: 2; }
.fill { stroke: none; fill: var(--robot); } .fill.touch { fill: var(--touch); } .fill.driven { fill: var(--driven); }
.fill.state-off, .fill.state-init { fill: #8a94a3; } .fill.state-homed { fill: #7f8fd0; }
.fill.state-ready { fill: #3d8bd4; } .fill.state-active { fill: #2e9e57; } .fill.state-degraded { fill: #e0a02a; }
.fill.state-safe_stop { fill: #d1453b; } .fill.state-e_stop { fill: #8e1f6d; }
"""
"""Everything a browser needs; nothing is fetched."""
