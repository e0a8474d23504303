"""Statistics of the errors of many runs against the bound and against the best estimate."""

import collections

import numpy as np

NUM_SIGN_FLIPS = 2000  # series drawn: the 95 % quantile's own error is then half a per cent


def ratio_of_means(values, others):
    """Square root of the ratio of two means over the same runs, and its standard error."""
    values, others = np.array(values), np.array(others)
    ratio = values.mean() / others.mean()
    spread = (values - ratio * others).std(ddof=1) / np.sqrt(len(values)) / others.mean()
    return np.sqrt(ratio), 0.5 * spread / np.sqrt(ratio)


def compare_with_ideal(runs, summary):
    """Adds to each category the map's error over that of the best estimate, same seeds."""
    squares = collections.defaultdict(list)
    for pairs, ideal in runs:
        of_run = collections.defaultdict(list)
        for key, (error, _) in pairs.items():
            if key in ideal and key[0] in summary:
                of_run[key[0]].append((error ** 2, ideal[key][0] ** 2))
        for category, values in of_run.items():
            squares[category].append(np.mean(values, axis=0))
    for category, values in squares.items():
        if len(values) < 2:
            continue
        ratio, ratio_error = ratio_of_means(*np.transpose(values))
        summary[category].update({"ideal_runs": len(values), "ideal_ratio": ratio,
                                  "ideal_ratio_error": ratio_error})


def summarise_pairs(runs, bound):
    """Category -> figures, over the pairs that the bound knows."""
    by_category = collections.defaultdict(list)  # one entry a run: list of (error^2, ...)
    errors_of_pair = collections.defaultdict(list)
    for pairs in runs:
        of_run = collections.defaultdict(list)
        for key, (error, variance) in pairs.items():
            if key in bound:
                of_run[key[0]].append((error ** 2, variance, bound[key], error))
                errors_of_pair[key].append(error)
        for category, values in of_run.items():
            by_category[category].append(np.mean(values, axis=0))
    result = {}
    for category, values in by_category.items():
        values = np.array(values)
        square, stated, best, mean = values.mean(axis=0)
        spread, _, _, mean_error = values.std(axis=0, ddof=1) / np.sqrt(len(values))
        bias = [np.mean(errors) / (np.std(errors, ddof=1) / np.sqrt(len(errors)))
                for key, errors in errors_of_pair.items()
                if key[0] == category and len(errors) > 2]
        result[category] = {
            "runs": len(values), "pairs": sum(key[0] == category for key in errors_of_pair),
            "stddev": np.sqrt(square), "bound": np.sqrt(best), "stated": np.sqrt(stated),
            "ratio": np.sqrt(square / best), "ratio_error": 0.5 * spread / square *
            np.sqrt(square / best),
            "mean": mean, "mean_error": mean_error,
            "nees": square / stated, "nees_error": spread / stated,
            "largest_bias": max(map(abs, bias)) if bias else None}
    return result


def mean_errors_in_standard_errors(errors):
    """Mean of each column over its standard error, over the rows that have a number there."""
    count = np.sum(~np.isnan(errors), axis=0)
    return np.nanmean(errors, axis=0) / (np.nanstd(errors, axis=0, ddof=1) / np.sqrt(count))


def judge_largest_bias(runs, bound):
    """The largest mean error of all quantities, in its standard errors, and how large it comes
    out by chance: errors that are no bias have either sign, so that runs with their signs drawn
    anew, all errors of a run together, show what noise alone makes of so many quantities and of
    their correlations. None where too few runs have any of them."""
    keys = sorted({key for pairs in runs for key in pairs if key in bound})
    errors = np.array([[pairs[key][0] if key in pairs else np.nan for key in keys]
                       for pairs in runs])
    often = np.sum(~np.isnan(errors), axis=0) > 2
    if not often.any():
        return None
    errors = errors[:, often]
    largest = np.abs(mean_errors_in_standard_errors(errors)).max()
    random = np.random.default_rng(1)
    by_chance = [np.abs(mean_errors_in_standard_errors(
        errors * random.choice([-1.0, 1.0], size=(len(errors), 1)))).max()
                 for _ in range(NUM_SIGN_FLIPS)]
    return {"quantities": int(often.sum()), "largest": largest,
            "limit": np.quantile(by_chance, 0.95),
            "chance": np.mean(np.array(by_chance) >= largest)}


def growth_exponent(summary, prefix, suffix):
    """Exponent of the growth of a standard deviation with the number of corners or loops."""
    points = [(int(name[len(prefix):].split()[0]), figures["stddev"])
              for name, figures in summary.items()
              if name.startswith(prefix) and name.endswith(suffix)]
    if len(points) < 2:
        return None
    numbers, values = np.array(sorted(points)).T
    return np.polyfit(np.log(numbers), np.log(values), 1)[0]
