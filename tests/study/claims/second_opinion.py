"""The verdicts once more, in plain pandas and scipy: it shares no code with neol.study.claims.

It reads paper/questions.yaml, the paper's tables and a frame of runs, and follows paper/plan.md.
Spending bounds of the last looks are integrated by scipy, the first look has a closed form.
"""

import math
from collections import Counter
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from ruamel.yaml import YAML
from scipy import integrate, optimize, stats

PAPER = Path(__file__).parents[3] / "paper"
QUESTIONS = YAML(typ="safe").load((PAPER / "questions.yaml").read_text(encoding="utf-8"))
TABLES = pd.read_csv(PAPER / "reference" / "tables.csv")
CONFIGURATIONS = pd.read_csv(PAPER / "reference" / "configurations.csv")
RULES = ["bcm", "hebb", "oja"]
SIZES, RATES = [50, 100, 200, 300], [0.00025, 0.0025, 0.025, 0.25]
LEVELS = dict(zip((10, 20, 30), 2 * stats.norm.sf([3.710303, 2.511427, 1.993048]), strict=True))
Triple = tuple[float, float, float]
"""A moment: value, standard error, degrees of freedom."""


class Study:
    """A frame of runs: task, method, population, rate (NaN for none), seed, and outcomes.

    `equal` has, for each question about equal cost, task and rule, the outcome by cell.
    """

    def __init__(self, runs: pd.DataFrame, generations: dict[str, int], equal: Any = None) -> None:
        self.runs, self.generations, self.equal = runs, generations, equal
        self.cells = runs.groupby(["task", "method", "population", "rate"], dropna=False)
        self.samples = {
            (task, method, size, None if np.isnan(rate) else rate): rows.sort_values("seed")
            for (task, method, size, rate), rows in self.cells
        }

    def grid(self, task: str, method: str) -> list[Any]:
        return [cell for cell in self.samples if cell[:2] == (task, method)]

    def answer(self, question: dict[str, Any], seeds: int) -> dict[str, Any]:
        """Everything but Holm's correction, which needs all questions."""
        kind, alpha = question["kind"], LEVELS.get(seeds, 0.05)
        found = getattr(self, f"ask_{kind}")(question, seeds, alpha)
        return {"id": question["id"], "alpha": alpha, "seeds": seeds} | found

    # --- Cells ------------------------------------------------------------------------------------

    def pick(self, side: dict[str, Any], task: str, method: str) -> tuple[list[Any], bool, bool]:
        """A choice: cells, whether the best of them is chosen, whether they are the paper's."""
        grid = self.grid(task, method)
        largest = [cell for cell in grid if cell[2] == max(each[2] for each in grid)]
        if side["cells"].startswith("table"):
            table = CONFIGURATIONS[CONFIGURATIONS["table"] == int(side["cells"][-1])]
            named = table[(table["task"] == task) & (table["method"] == method)]
            wanted = [
                cell
                for cell in grid
                if len(named)
                and cell[2] == named["population"].iloc[0]
                and (cell[3] is None or cell[3] == named["learning_rate"].iloc[0])
            ]
            return (wanted, False, True) if wanted else (largest, True, False)
        if side["cells"] == "largest":
            rates = {cell[3] for cell in largest}
            papers = bool(largest) and largest[0][2] == 300 and rates in ({None}, set(RATES))
            return largest, True, papers
        sizes, rates = side.get("populations", SIZES), side.get("learning_rates", RATES)
        wanted = [
            cell for cell in grid if cell[2] in sizes and (cell[3] is None or cell[3] in rates)
        ]
        learns = any(cell[3] is not None for cell in wanted)
        papers = len(wanted) == len(sizes) * (len(rates) if learns else 1)
        return wanted, side["cells"] == "best", papers

    def matrix(self, cells: list[Any], one_of: bool, outcome: str, seeds: int) -> Any:
        rows = np.array([self.samples[cell][outcome].to_numpy()[:seeds] for cell in cells])
        if one_of and len(cells) > 1:
            best = max(range(len(cells)), key=lambda place: rows[place, ::2].mean())
            return rows[[best], 1::2]
        return rows

    def stack(self, picked: Any, outcome: str, seeds: int) -> Any:
        is_halved = [one and len(cells) > 1 for cells, one, _ in picked]
        rows = [self.matrix(cells, one, outcome, seeds) for cells, one, _ in picked]
        if any(is_halved):
            rows = [each if half else each[:, 1::2]
                    for each, half in zip(rows, is_halved, strict=True)]  # fmt: skip
        return np.concatenate(rows)

    # --- Questions --------------------------------------------------------------------------------

    def ask_difference(self, question: dict[str, Any], seeds: int, alpha: float) -> dict[str, Any]:
        tasks, than = question["tasks"], question.get("than_tasks", [])
        rules = question.get("rules", RULES)
        parts = [self.compare(question, [task], [], [rule], seeds)
                 for task, rule in product(tasks, rules)]  # fmt: skip
        if than:
            parts = [self.compare(question, tasks, than, [rule], seeds) for rule in rules]
        whole = self.compare(question, tasks, than, rules, seeds)
        papers_cells = all(part["papers_cells"] for part in parts)
        expect, paper = question["expect"], whole["paper"]
        states = Counter(state(part["ours"], expect, part["margin"], alpha) for part in parts)
        return whole | {"states": states, "expect": expect, "papers_cells": papers_cells,
                        "family": question.get("family"), "paper": paper}  # fmt: skip

    def compare(
        self, question: dict[str, Any], tasks: Any, than: Any, rules: Any, seeds: int
    ) -> dict[str, Any]:
        side, against, outcome = question["side"], question["against"], question["outcome"]
        statistic, scale = question.get("statistic", "mean"), question.get("scale", "raw")
        ours, papers, margins, papers_cells = {}, {}, [], True
        for task in [*tasks, *than]:
            first = [self.pick(side, task, side.get("method", rule)) for rule in rules]
            second = [self.pick(against, task, against.get("method", rule)) for rule in rules]
            second = second if "method" not in against else second[:1]
            papers_cells &= all(cells and named for cells, _, named in [*first, *second])
            if all(cells for cells, _, _ in [*first, *second]):
                lookup = self
                if outcome == "equal_evaluations":
                    lookup = self.equal(question["id"], task, [*first, *second])
                a, b = (lookup.stack(part, outcome, seeds) for part in (first, second))
                ours[task] = contrast(moments(a, statistic), moments(b, statistic), scale)
            margin = question.get("margin", 0.5)
            base = against.get("method")
            one = printed(outcome, side["cells"], task, rules, base)
            two = printed(outcome, against["cells"], task, [base], base)
            if one and two:
                papers[task] = contrast(one[statistic], two[statistic], scale)
            if scale == "raw" and statistic == "mean":
                margin *= two["mean"][3] if two else 0.0
            margins.append(margin)
        value = whole_of(ours, tasks, than)
        return {"ours": value, "paper": whole_of(papers, tasks, than), "margin":
                float(np.mean(margins[: len(tasks)])), "papers_cells": papers_cells}  # fmt: skip

    def ask_interaction(self, question: dict[str, Any], seeds: int, alpha: float) -> dict[str, Any]:
        task = question["tasks"][0]
        table = CONFIGURATIONS[(CONFIGURATIONS["table"] == 4) & (CONFIGURATIONS["task"] == task)]
        rates = table.set_index("method")["learning_rate"]

        def contrast_of(rules: list[str]) -> Triple | None:
            """(rule and mutation - mutation) - (rule - neither), in SDs of a run."""
            both = [(task, f"{rule}_mutated", 300, rates[rule]) for rule in rules]
            rule = [(task, rule, 300, rates[rule]) for rule in rules]
            neat, neither = ([(task, name, 300, None)] * len(rules) for name in ("neat", "neat_wo"))
            if not all(cell in self.samples for cell in [*both, *rule, *neat, *neither]):
                return None
            first, second = (
                moments(self.matrix(cells, False, question["outcome"], seeds), "mean")
                for cells in (both + neither, rule + neat)
            )
            half = contrast(first, second, "sd")
            return None if half is None else add([half], [2])

        parts = [contrast_of([rule]) for rule in RULES]
        states = Counter(state(part, "higher", 0.0, alpha) for part in parts)
        there = None not in parts
        return {"ours": contrast_of(RULES), "paper": None, "margin": 0.5, "states": states,
                "expect": "higher", "papers_cells": there, "family": "patterns"}  # fmt: skip

    def ask_sensitivity(self, question: dict[str, Any], seeds: int, alpha: float) -> dict[str, Any]:
        parts, wholes = [], []
        papers = True
        for task in question["tasks"]:
            varied = []
            for rule in (question["rule"], *question["than"]):
                cells = self.grid(task, rule)
                papers &= len(cells) == 16
                has_rates = len({cell[3] for cell in cells}) > 1
                varied.append(
                    self.between_rates(cells, question["outcome"], seeds) if has_rates else None
                )
            first, *rest = varied
            parts += [add([first, each], (1, -1)) if first and each else None for each in rest]
            weights = [1] + [-1 / len(rest)] * len(rest)  # the rule's own error counts once
            wholes.append(add(varied, weights) if all(varied) else None)
        whole = add(wholes, [1 / len(wholes)] * len(wholes)) if all(wholes) else None
        states = Counter(state(part, "higher", 0.0, alpha) for part in parts)
        return {"ours": whole, "paper": None, "margin": 0.0, "states": states, "expect": "higher",
                "papers_cells": papers, "family": "patterns"}  # fmt: skip

    def between_rates(self, cells: list[Any], outcome: str, seeds: int) -> Triple:
        rows = self.matrix(cells, False, outcome, seeds)
        sizes = np.array([cell[2] for cell in cells])
        noise = rows.var(axis=1, ddof=1).mean() or 1.0

        def component(table: Any) -> float:
            """Between-rate variance of the means, minus what the noise of the means adds."""
            found = []
            for size in np.unique(sizes):
                block = table[sizes == size]
                rates, n = block.shape
                residual = block - block.mean(axis=0) - block.mean(axis=1)[:, None] + block.mean()
                error = (residual**2).sum() / ((rates - 1) * (n - 1))
                found.append(block.mean(axis=1).var(ddof=1) - error / n)
            return float(np.mean(found) / noise)

        n = rows.shape[1]
        left_out = [component(np.delete(rows, place, axis=1)) for place in range(n)]
        return component(rows), math.sqrt((n - 1) * np.var(left_out)), n - 1

    def ask_rank(self, question: dict[str, Any], seeds: int, alpha: float) -> dict[str, Any]:
        states, papers_cells, complete = Counter[str](), True, True
        for task in question["tasks"]:
            rank = question["ranks"][task]
            first, most = rank["rule"], rank["at_most"]
            methods = [first, *(rule for rule in RULES if rule != first), question["against"]]
            picked = [self.pick({"cells": question["cells"]}, task, each) for each in methods]
            papers_cells &= all(cells and named for cells, _, named in picked)
            if not all(cells for cells, _, _ in picked):
                states["open"] += 1
                complete = False
                continue
            rows = [self.matrix(cells, one, question["outcome"], seeds)[0]
                    for cells, one, _ in picked]  # fmt: skip
            above = sorted(welch_less(rows[0], other) for other in rows[1:])
            below = sorted(welch_less(other, rows[0]) for other in rows[1:])
            rivals = len(above)
            if most * below[rivals - most] < alpha / 2:
                states["for"] += 1
            elif (rivals - most + 1) * above[most - 1] < alpha / 2:
                states["against"] += 1
            else:
                states["open"] += 1
        return {"ours": None, "paper": None, "margin": 0.0, "states": states, "expect": None,
                "papers_cells": papers_cells, "family": None, "complete": complete}  # fmt: skip

    def ask_ceiling(self, question: dict[str, Any], seeds: int, alpha: float) -> dict[str, Any]:
        states, papers_cells = Counter[str](), True
        for method in [*RULES, "neat", "neat_wo"]:
            table = "table4" if method == "neat_wo" else "table3"
            cells, one, named = self.pick({"cells": table}, "cartpole", method)
            papers_cells &= bool(cells) and named
            if not cells:
                states["open"] += 1
                continue
            values = self.matrix(cells, one, "final_best", seeds)[0]
            hits = int((values >= question["level"]).sum())
            exact = stats.binomtest(hits, len(values), alternative="greater")
            low = exact.proportion_ci(1 - alpha).low
            high = stats.binomtest(hits, len(values), alternative="less").proportion_ci(1 - alpha)
            states["for" if low >= question["share"]
                   else "against" if high.high < question["share"] else "open"] += 1  # fmt: skip
        return {"ours": None, "paper": None, "margin": 0.0, "states": states, "expect": None,
                "papers_cells": papers_cells, "family": None}  # fmt: skip

    def ask_printed(self, question: dict[str, Any], seeds: int, alpha: float) -> dict[str, Any]:
        states, p_values, papers_cells = Counter[str](), [], True
        for outcome, task in product(("final_best", "score"), question["tasks"]):
            for method in [*RULES, "neat", "neat_wo"]:
                base = method if method.startswith("neat") else "neat"
                setting = "table4" if base == "neat_wo" else "table3"
                setting = "largest" if outcome == "score" else setting
                cells, one, named = self.pick({"cells": setting}, task, method)
                papers_cells &= bool(cells) and named
                paper = printed(outcome, setting, task, [method], base)
                if not cells or not paper:
                    states["open"] += 1
                    continue
                rows = self.matrix(cells, one, outcome, seeds)
                gap = add([moments(rows, "mean")[:3], paper["mean"][:3]], (1, -1))
                p_values.append(p_of(gap))
                states["for" if p_values[-1] >= alpha else "against"] += 1
        fisher = -2 * np.sum(np.log(np.maximum(p_values, 1e-300)))
        p = stats.chi2.sf(fisher, 2 * len(p_values)) if p_values else math.nan
        return {"ours": None, "paper": None, "margin": 0.0, "states": states, "expect": None,
                "papers_cells": papers_cells, "family": None, "printed": p}  # fmt: skip


def opinions(study: Study) -> pd.DataFrame:
    """Return a row for each question: verdict, effect, low, high, p_holm, for, against, open."""
    counts = study.cells.size()
    rows = []
    for question in QUESTIONS["questions"]:
        tasks = [*question["tasks"], *question.get("than_tasks", [])]
        there = counts[counts.index.get_level_values("task").isin(tasks)]
        seeds = int(there.min()) if len(there) else 0
        seeds = max((look for look in LEVELS if look <= seeds), default=seeds)
        row = study.answer(question, seeds)
        ours = row["ours"]
        is_tested = ours and row["family"] and can_answer(row | {"question": question}, study)
        row["p"] = overall(p_of(ours), seeds) if is_tested else math.nan
        rows.append(row | {"question": question})
    for family in {row["family"] for row in rows} - {None}:
        members = sorted(
            (row for row in rows if row["family"] == family),
            key=lambda row: 1.0 if math.isnan(row["p"]) else row["p"],
        )
        running = 0.0
        for place, row in enumerate(members):
            p = 1.0 if math.isnan(row["p"]) else row["p"]
            running = min(1.0, max(running, p * (len(members) - place)))
            row["p_holm"] = running
    frame = [
        {
            "question": row["id"],
            "verdict": verdict(row, study),
            "effect": row["ours"][0] if row["ours"] else math.nan,
            **dict(zip(("low", "high"), limits(row["ours"], row["alpha"]), strict=True)),
            "p_holm": row["p_holm"] if not math.isnan(row["p"]) else math.nan,
            **{each: row["states"][each] for each in ("for", "against", "open")},
        }
        for row in rows
    ]
    return pd.DataFrame(frame).set_index("question")


def verdict(row: dict[str, Any], study: Study) -> str:
    question, states, alpha = row["question"], row["states"], row["alpha"]
    if "by_construction" in question:
        return "holds by construction"
    if not row["papers_cells"] or row["seeds"] < 10:
        return "not asked here"
    found = judged(row, states, alpha)
    reached = (row["id"], found) == ("cartpole-ceiling", "reproduced")
    return found if can_answer(row, study) or reached else "too short"


def can_answer(row: dict[str, Any], study: Study) -> bool:
    """Return whether the paper's cells are there, with a look's seeds and enough generations."""
    tasks = [*row["question"]["tasks"], *row["question"].get("than_tasks", [])]
    there = row["papers_cells"] and row["seeds"] >= 10
    return bool(there) and min(study.generations[task] for task in tasks) >= 500


def judged(row: dict[str, Any], states: Any, alpha: float) -> str:
    if "printed" in row:
        return "reproduced" if row["printed"] >= alpha else "not reproduced"
    if row["expect"] is None:
        if states["against"]:
            return "not reproduced"
        return "inconclusive" if states["open"] else "reproduced"
    ours, paper, margin, expect = row["ours"], row["paper"], row["margin"], row["expect"]
    if ours is None:
        return "inconclusive"
    if expect in ("equal", "not_lower"):
        words = {"for": "reproduced", "against": "not reproduced", "open": "inconclusive"}
        found = words[state(ours, expect, margin, alpha)]
        return "mixed" if found == "reproduced" and states["against"] else found
    sign = -1 if expect == "lower" else 1
    low, high = limits(add([ours, paper], (1, -1)), alpha) if paper else (0.0, 0.0)
    predicted = low <= 0 <= high
    if row["p_holm"] < 0.05:
        if sign * ours[0] < 0:
            return "not reproduced"
        if states["against"]:
            return "mixed"
        return "reproduced" if predicted else "same direction"
    low, high = limits(ours, 2 * alpha)
    if -margin < low and high < margin:
        return "equivalent to zero"
    if paper and not predicted and sign * (paper[0] - ours[0]) > 0:
        return "not reproduced"
    best = high if sign > 0 else -low
    return "not reproduced" if paper and best < telescope(paper) else "inconclusive"


def state(ours: Triple | None, expect: str, margin: float, alpha: float) -> str:
    if ours is None:
        return "open"
    (low, high), (inner_low, inner_high) = limits(ours, alpha), limits(ours, 2 * alpha)
    if expect == "equal":
        yes, no = -margin < inner_low and inner_high < margin, low > margin or high < -margin
    elif expect == "not_lower":
        yes, no = inner_low > -margin, high < -margin
    else:
        yes, no = (low > 0, high < 0) if expect == "higher" else (high < 0, low > 0)
    return "for" if yes else "against" if no else "open"


# --- Numbers --------------------------------------------------------------------------------------


def moments(rows: Any, statistic: str) -> tuple[float, float, float, float]:
    """Value, error, degrees of freedom, and the root of the mean variance, of float64[cells, n]."""
    n, sd = rows.shape[1], math.sqrt(np.mean(rows.var(axis=1, ddof=1)))
    if statistic == "mean":
        each = rows.mean(axis=0)
        return each.mean(), each.std(ddof=1) / math.sqrt(n), n - 1, sd
    logs = []
    for row in rows:
        if row.std() == 0:
            return math.nan, math.nan, n - 1, sd
        without = np.array([np.log(np.delete(row, i).std(ddof=1)) for i in range(n)])
        logs.append((np.log(row.std(ddof=1)), math.sqrt((n - 1) * np.var(without)), n - 1))
    return (*add(logs, [1 / len(logs)] * len(logs)), sd)


def printed(outcome: str, setting: str, task: str, methods: Any, base: Any) -> Any:
    """Return the paper's mean and spread in the form of `moments`, by statistic; None if absent."""
    numbers = {("final_best", "neat"): 1, ("final_best", "neat_wo"): 7,
               ("score", "neat"): 2, ("score", "neat_wo"): 8}  # fmt: skip
    settings = {"final_best": ("table3", "table4"), "score": ("largest",)}
    if (outcome, base) not in numbers or setting not in settings[outcome]:
        return None
    table = TABLES[(TABLES["table"] == numbers[outcome, base]) & (TABLES["task"] == task)]
    rows = [table[table["column"] == method] for method in methods]
    if not all(map(len, rows)):
        return None
    means = [float(row["value"].iloc[0]) for row in rows]
    sds = [float(row["sd"].iloc[0]) for row in rows]
    sd, share = math.sqrt(np.mean(np.square(sds))), [1 / len(rows)] * len(rows)
    mean = add([(m, s / math.sqrt(30), 29) for m, s in zip(means, sds, strict=True)], share)
    spread = (math.nan,) * 3
    if min(sds) > 0:
        spread = add([(math.log(s), 1 / math.sqrt(58), 29) for s in sds], share)
    return {"mean": (*mean, sd), "spread": (*spread, sd)}


def contrast(first: Any, second: Any, scale: str) -> Triple | None:
    value, error, df = add([first[:3], second[:3]], (1, -1))
    if math.isnan(value):
        return None
    if scale == "sd":
        variance = (first[3] ** 2 + second[3] ** 2) / 2
        if variance == 0:
            return (0.0, 0.0, df) if value == 0 else None
        # Error of the divisor: var(s^2) = 2 s^4 / df on each side, halved in the average.
        doubt = sum(2 * each[3] ** 4 / each[2] for each in (first, second)) / 4
        g = value / math.sqrt(variance)
        return g, math.sqrt(error**2 / variance + g**2 * doubt / (4 * variance**2)), df
    if scale == "relative":
        base = second[0]
        weights = (1 / abs(base), -first[0] / (base * abs(base)))
        _, error, df = add([first[:3], second[:3]], weights)
        return value / abs(base), error, df
    return value, error, df


def add(terms: Any, weights: Any) -> Triple:
    parts = [(w * e) ** 2 for w, (_, e, _) in zip(weights, terms, strict=True)]
    value = sum(w * v for w, (v, _, _) in zip(weights, terms, strict=True))
    if not sum(parts):
        return value, 0.0, min(df for _, _, df in terms)
    down = sum(part**2 / df for part, (_, _, df) in zip(parts, terms, strict=True))
    return value, math.sqrt(sum(parts)), sum(parts) ** 2 / down


def whole_of(each: dict[str, Any], tasks: Any, than: Any) -> Triple | None:
    if any(each.get(task) is None for task in [*tasks, *than]):
        return None
    weights = [1 / len(tasks)] * len(tasks) + [-1 / max(1, len(than))] * len(than)
    return add([each[task] for task in [*tasks, *than]], weights)


def limits(effect: Triple | None, alpha: float) -> tuple[float, float]:
    if effect is None:
        return math.nan, math.nan
    value, error, df = effect
    reach = error * stats.t.ppf(1 - alpha / 2, df) if error else 0.0
    return value - reach, value + reach


def p_of(effect: Triple) -> float:
    value, error, df = effect
    return 2 * stats.t.cdf(-abs(value) / error, df) if error else float(value == 0)


def welch_less(first: Any, second: Any) -> float:
    """One-sided p-value of the first having the lower mean."""
    return float(stats.ttest_ind(first, second, equal_var=False, alternative="less").pvalue)


def telescope(paper: Triple) -> float:
    """Return Simonsohn's effect: the one that the paper's study finds with a power of one third."""
    _, error, df = paper
    critical = stats.t.ppf(0.975, df)
    sizes = np.linspace(0, 4, 4001)
    return error * float(np.interp(1 / 3, stats.nct.sf(critical, df, sizes), sizes))


def overall(p: float, seeds: int) -> float:
    """The level of all looks together at which a look's own p-value just rejects."""
    if seeds == 10:
        return 4 * stats.norm.sf(math.sqrt(1 / 3) * stats.norm.isf(p / 4)) if p < 1 else 1.0
    if p > 0.2 or p < 1e-11:
        return p  # far from every decision
    z = stats.norm.isf(p / 2)
    share = seeds / 30

    def spent_by(alpha: float, time: float) -> float:
        return 4 * stats.norm.sf(stats.norm.isf(alpha / 4) / math.sqrt(time))

    def excess_at_the_second(log_alpha: float) -> float:
        alpha = math.exp(log_alpha)
        first = stats.norm.isf(spent_by(alpha, 1 / 3) / 2)
        return (1 - stays(first, z)) - spent_by(alpha, share)

    if seeds == 20:
        return math.exp(optimize.brentq(excess_at_the_second, math.log(p), 0.0, xtol=1e-4))

    def excess(log_alpha: float) -> float:
        alpha = math.exp(log_alpha)
        spent = [spent_by(alpha, time) for time in (1 / 3, 2 / 3)]
        first = stats.norm.isf(spent[0] / 2)
        second = optimize.brentq(lambda b: 1 - stays(first, b) - spent[1], 0.5, 12)
        return (1 - stays(first, second, z)) - alpha

    return math.exp(optimize.brentq(excess, math.log(p), math.log(min(1.0, 3 * p)), xtol=1e-4))


def stays(first: float, second: float, third: float | None = None) -> float:
    """Probability that Z at 1/3, 2/3 and 1 of the information stays inside all bounds."""
    a, b = first * math.sqrt(1 / 3), second * math.sqrt(2 / 3)
    step = math.sqrt(1 / 3)

    def last(y: Any) -> Any:
        if third is None:
            return 1.0
        return stats.norm.cdf((third - y) / step) - stats.norm.cdf((-third - y) / step)

    nodes, weights = np.polynomial.legendre.leggauss(80)
    y = nodes * b
    tails = last(y)

    def density(x: Any) -> Any:  # stats.norm.pdf takes ten times as long
        return np.exp(-0.5 * (x / step) ** 2) / (step * math.sqrt(2 * math.pi))

    def inner(x: float) -> float:
        return float(np.sum(weights * b * density(y - x) * tails))

    return float(integrate.quad(lambda x: density(x) * inner(x), -a, a, epsabs=1e-10)[0])
