"""The leaderboard: reports side by side as one static HTML page without scripts."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

from camp.evaluation.report import Estimate, PolicySummary, Report
from camp.metrics.statistics import rare_interval
from camp.robots.registry import DEFAULT_ROBOT

STYLE = """
body{font:15px/1.45 system-ui,sans-serif;margin:2rem auto;max-width:76rem;padding:0 1rem;color:#1c1e21;background:#fff}
table{border-collapse:collapse;margin:.6rem 0 1.6rem;width:100%}
th,td{padding:.35rem .6rem;border-bottom:1px solid #dfe3e8;text-align:left;vertical-align:middle}
th{font-weight:600;font-size:.86rem} td.n{text-align:right;font-variant-numeric:tabular-nums}
small{color:#5b6470} .bar{position:relative;display:block;width:8rem;height:.7rem;background:#eceff3;border-radius:2px}
.bar i{position:absolute;top:0;bottom:0;background:#a9c7e8} .bar b{position:absolute;top:-2px;bottom:-2px;width:2px;
background:#174a7c} .baseline td{color:#5b6470} caption{text-align:left;font-weight:600;padding:.3rem 0}
td.s{text-align:center;font-variant-numeric:tabular-nums;font-size:.86rem}
"""
INTRO = """Gaits are judged by foot contacts and foot heights alone, the whole walk by every criterion (docs/judge.md).
Bars: the 95-% interval, with the estimate as a line. Rows of different suites stand under different headings: their
figures cannot be compared. One row is one policy: another seed of its training may differ by more than its interval."""


def leaderboard_page(reports: Sequence[Report]) -> str:
    """The whole page; reports in any order."""
    suites = list(dict.fromkeys(_suite(report) for report in sorted(reports, key=_order)))
    parts = [_section(suite, [r for r in reports if _suite(r) == suite]) for suite in suites]
    return (
        '<!doctype html><html lang="en"><meta charset="utf-8"><title>camp: who walks how</title>'
        f"<style>{STYLE}</style><h1>Gaits, judged</h1><p>{INTRO}</p>{''.join(parts)}</html>\n"
    )


def _order(report: Report) -> tuple[bool, bool, str, str]:
    return (report.suite.name != "v1", report.suite.robot != DEFAULT_ROBOT, report.suite.name, report.suite.robot)


def _suite(report: Report) -> str:
    found = report.suite
    digests = f"values {found.digest} · thresholds {found.thresholds} · model {found.model}"
    return f"suite {found.name} · {found.robot} · {digests}"


def _section(suite: str, reports: Sequence[Report]) -> str:
    ranked = sorted(reports, key=lambda report: -_accuracy(report.policies["trained"]) if report.policies else 0.0)
    return f"<h2>{escape(suite)}</h2>{_headline(ranked)}{_skills(ranked)}"


def _accuracy(walks: PolicySummary) -> float:
    return walks.all.gait_accuracy.value if walks.all.gait_accuracy else 0.0


def _headline(reports: Sequence[Report]) -> str:
    headings = (
        *("policy", "gait right, nominal", "weakest skill", "gait right, Table I", "switches within 1 s"),
        *("falls per 100, nominal", "velocity error, m/s", "yaw rate error, rad/s", "reference skill score"),
    )
    rows = []
    for report in reports:
        if "trained" not in report.policies:
            continue
        rows.append(_row(report))
    rows += [
        _baseline_row(name, walks)
        for name, walks in {
            name: walks for report in reports for name, walks in report.policies.items() if name != "trained"
        }.items()
    ]
    head = "".join(f"<th>{heading}</th>" for heading in headings)
    return f"<table><tr>{head}</tr>{''.join(rows)}</table>"


def _row(report: Report) -> str:
    walks, table_i, switching = report.policies["trained"], report.table_i, report.switching
    accuracy = {name: part.gait_accuracy for name, part in walks.skills.items() if part.gait_accuracy}
    weakest = min(accuracy, key=lambda name: accuracy[name].value) if accuracy else ""
    errors, reference = report.tracking.get("all"), report.reference.get("all")
    score = [f"{part.skill:.2f}" for part in reference.policy.values()] if reference else []
    detail = [f"seed {report.seed}"] if report.seed is not None else []
    detail += [f"{len(report.skills)} skill{'s' * (len(report.skills) != 1)}"] + (
        ["own command range"] if report.commands_clipped else []
    )
    cells = [
        f"<td>{escape(report.run)}<br><small>{', '.join(detail)}</small></td>",
        _fraction(walks.all.gait_accuracy),
        _fraction(accuracy.get(weakest), weakest),
        _fraction(table_i.walks.all.gait_accuracy if table_i else None),
        _fraction(switching.all.completed if switching else None),
        _falls(walks.all.falls, walks.all.rollouts),
        _mean(errors.linear_error_m_s if errors else None),
        _mean(errors.yaw_rate_error_rad_s if errors else None),
        f'<td class="n">{", ".join(score) or "–"}</td>',
    ]
    return f"<tr>{''.join(cells)}</tr>"


def _baseline_row(name: str, walks: PolicySummary) -> str:
    empty = '<td class="n">–</td>'
    cells = [
        f"<td>{escape(name)}<br><small>baseline</small></td>",
        _fraction(walks.all.gait_accuracy),
        *[empty] * 3,
        _falls(walks.all.falls, walks.all.rollouts),
        f'<td class="n">{walks.all.linear_error_m_s:.3f}</td><td class="n">{walks.all.yaw_rate_error_rad_s:.3f}</td>',
        empty,
    ]
    return f'<tr class="baseline">{"".join(cells)}</tr>'


def _skills(reports: Sequence[Report]) -> str:
    """Gait accuracy of every skill, shaded."""
    shown = [report for report in reports if "trained" in report.policies]
    skills = list(dict.fromkeys(skill for report in shown for skill in report.skills))
    head = "".join(f"<th>{escape(skill)}</th>" for skill in skills)
    rows = []
    for report in shown:
        parts = report.policies["trained"].skills
        cells = []
        for skill in skills:
            found = parts[skill].gait_accuracy if skill in parts else None
            if found is None:
                cells.append('<td class="s">–</td>')
            else:
                shade = f"background:rgba(60,120,190,{0.5 * found.value:.2f})"
                cells.append(
                    f'<td class="s" style="{shade}">{100 * found.value:.0f} %<br><small>n {found.n}</small></td>'
                )
        rows.append(f"<tr><td>{escape(report.run)}</td>{''.join(cells)}</tr>")
    return f"<table><caption>gait right by skill, nominal</caption><tr><th></th>{head}</tr>{''.join(rows)}</table>"


def _fraction(found: Estimate | None, note: str = "") -> str:
    if found is None:
        return '<td class="n">–</td>'
    low, width, mark = (f"{100 * value:.1f}%" for value in (found.low, found.high - found.low, found.value))
    bar = f'<span class="bar"><i style="left:{low};width:{width}"></i><b style="left:{mark}"></b></span>'
    text = f"{100 * found.value:.0f} % <small>[{100 * found.low:.0f}, {100 * found.high:.0f}], n {found.n}"
    return f"<td>{text}{f', {escape(note)}' if note else ''}</small>{bar}</td>"


def _falls(falls: int, walks: int) -> str:
    found = rare_interval(falls, walks)
    if found is None:
        return '<td class="n">–</td>'
    return f'<td class="n">{100 * found.value:.1f}<br><small>at most {100 * found.high:.1f}, n {walks}</small></td>'


def _mean(found: Estimate | None) -> str:
    if found is None:
        return '<td class="n">–</td>'
    return f'<td class="n">{found.value:.3f}<br><small>[{found.low:.3f}, {found.high:.3f}]</small></td>'
