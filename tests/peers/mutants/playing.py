"""Rules of playing: sections 2 (*Law*), 6 and 11 of the text, and the cases of `playing-conformance`."""

from __future__ import annotations

from .mutant import Mutant

LAW, AXES, MESH, PLAYING, MIXING, SHAPES = "law.py", "axes.py", "mesh.py", "playing.py", "mixing.py", "shapes.py"

# Groups and positions on an axis (rule 1).
AXIS = [
    Mutant("values are the same within 4 %", AXES, "SAME = 0.05", "SAME = 0.04"),
    Mutant("values are the same within 6 %", AXES, "SAME = 0.05", "SAME = 0.06"),
    Mutant("5 % of the smaller value", AXES, "SAME * max(abs(a), abs(b))", "SAME * min(abs(a), abs(b))"),
    Mutant("a value joins if it is the same as the greatest of the group", AXES, "groups[-1][0])", "groups[-1][-1])"),
    Mutant("a group's position is that of its smallest value", AXES, "(g[0] + g[-1]) / 2 / self.scale", "g[0] / self.scale"),
    Mutant("a group's position is that of its greatest value", AXES, "(g[0] + g[-1]) / 2 / self.scale", "g[-1] / self.scale"),
    Mutant("a group's position is the mean of all its values", AXES, "(g[0] + g[-1]) / 2 / self.scale", "sum(g) / len(g) / self.scale"),
    Mutant("axes are not scaled", AXES, "        self.scale = greatest or 1.0\n        self.groups", "        self.scale = 1.0\n        self.groups"),
    Mutant("axes are scaled by their smallest value", AXES, "        self.scale = greatest or 1.0\n        self.groups", "        self.scale = ascending[0] or 1.0\n        self.groups"),
    Mutant("positions between groups begin at the smallest value", AXES, "part = (value - previous.high) / (group.low - previous.high)\n                return previous", "part = (value - previous.low) / (group.low - previous.low)\n                return previous"),
    Mutant("positions between groups end at the greatest value", AXES, "part = (value - previous.high) / (group.low - previous.high)\n                return previous", "part = (value - previous.high) / (group.high - previous.high)\n                return previous"),
    Mutant("positions end below the groups", AXES, "return first.position - (first.low - value) / self.scale", "return first.position"),
    Mutant("positions end above the groups", AXES, "return last.position + (value - last.high) / self.scale", "return last.position"),
    Mutant("values are never grouped", PLAYING, "for grouped in (True, False):", "for grouped in (False,):"),
    Mutant("values are grouped at equal positions too", PLAYING, "for grouped in (True, False):", "for grouped in (True,):"),
    Mutant("an axis with an absent value has a ratio", AXES, "greatest > 0 and None not in values", "greatest > 0"),
    Mutant("an axis whose values are 0 has a ratio", AXES, "self.complete = greatest > 0 and None not in values", "self.complete = None not in values",
           "the nearest value is then 0, which has the ratio 1 as well"),
    Mutant("a nearest value of 0 has a ratio", PLAYING, "value / nearest if nearest > 0 else 1.0", "value / nearest if nearest > 0 else 8.0 if axis.complete else 1.0"),
    Mutant("a foot at a group has the group's smallest value", AXES, "return min(max(value, group.low), group.high)", "return group.low"),
    Mutant("a foot at a group has the group's greatest value", AXES, "return min(max(value, group.low), group.high)", "return group.high"),
    Mutant("a foot is at a group only without rounding", AXES, "AT_GROUP = 1e-9", "AT_GROUP = 0.0"),
    Mutant("a foot between groups has the value of the one below", AXES, "return before.high + part * (after.low - before.high)", "return before.high"),
    Mutant("a foot between groups counts from the smallest values", AXES, "return before.high + part * (after.low - before.high)", "return before.low + part * (after.low - before.low)"),
]

# The triangulation (rule 2).
TRIANGULATION = [
    Mutant("the fan of a cell is from its last position", MESH, "apex = min(corners, key=lambda i: self.points[i])", "apex = max(corners, key=lambda i: self.points[i])"),
    Mutant("the fan of a cell is from the least position on the axis of forces", MESH, "apex = min(corners, key=lambda i: self.points[i])", "apex = min(corners, key=lambda i: self.points[i][::-1])"),
    Mutant("of equal speeds the fan is from the greater force", MESH, "apex = min(corners, key=lambda i: self.points[i])", "apex = min(corners, key=lambda i: (self.points[i][0], -self.points[i][1]))"),
    Mutant("triangles of one cell are not joined", MESH, "if abs(angles - math.pi) <= HALF_TURN_WITHIN:", "if False:"),
    Mutant("angles sum to half a turn within 0.01 rad", MESH, "HALF_TURN_WITHIN = 1e-9", "HALF_TURN_WITHIN = 1e-2"),
    Mutant("angles sum to half a turn without rounding only", MESH, "HALF_TURN_WITHIN = 1e-9", "HALF_TURN_WITHIN = 0.0"),
    Mutant("a position may lie inside a circle", MESH, "if in_circle(p[a], p[b], p[best], p[c]) > 0:", "if in_circle(p[a], p[b], p[best], p[c]) < 0:"),
]

# Conditions that belong to an edge of the hull (rule 3).
FLAT = "        triangle = at.get(side)\n"
EDGES = [
    Mutant("no condition belongs to an edge", MESH, FLAT, "        return\n" + FLAT),
    Mutant("a condition that is the same on one axis belongs to an edge", MESH, "if not all(same(x, y) for x, y", "if not any(same(x, y) for x, y"),
    Mutant("any condition with its foot on an edge belongs to it", MESH, "        if not all(same(x, y) for x, y in zip(self.points[corner], place)):\n            return\n", ""),
    Mutant("triangles behind the first are used", MESH, "        self.absorb(edge, at, (side[0], corner), (span[0], part))\n        self.absorb(edge, at, (corner, side[1]), (part, span[1]))\n", ""),
    Mutant("triangles behind one on its lower side are used", MESH, "        self.absorb(edge, at, (side[0], corner), (span[0], part))\n", ""),
    Mutant("triangles behind one on its upper side are used", MESH, "        self.absorb(edge, at, (corner, side[1]), (part, span[1]))\n", ""),
    Mutant("feet need not be in order along the edge", MESH, "if not span[0] < part < span[1]:", "if not 0 < part < 1:"),
    Mutant("edges take triangles in descending order", MESH, "return sorted(outer, key=lambda side: sorted(self.points[i] for i in side))", "return sorted(outer, key=lambda side: sorted(self.points[i] for i in side), reverse=True)"),
    Mutant("edges are ordered by their forces", MESH, "key=lambda side: sorted(self.points[i] for i in side))", "key=lambda side: sorted(self.points[i][::-1] for i in side))"),
    Mutant("each edge takes one triangle before any takes more", MESH,
           "            self.edges.append(edge)\n            self.absorb(edge, at, (a, b), (0.0, 1.0))\n            edge.feet.sort()\n",
           "            self.edges.append(edge)\n        recurse, self.absorb = self.absorb, lambda *todo: later.append(todo)\n"
           "        later = [(edge, at, edge.ends, (0.0, 1.0)) for edge in self.edges]\n"
           "        while later:\n            recurse(*later.pop(0))\n"
           "        for edge in self.edges:\n            edge.feet.sort()\n"),
    Mutant("a triangle may belong to two edges", MESH, "if triangle is None or triangle in self.edge_of:", "if triangle is None:"),
    Mutant("a triangle that is not used has barycentric weights", MESH, "if triangle in self.edge_of:\n                edge", "if False:\n                edge"),
    Mutant("a motion in a triangle that is not used starts from its foot", MESH, "return self.on_edge(edge, self.foot(edge.ends, point)), None", "part = self.foot(edge.ends, point)\n                return self.on_edge(edge, part), self.along(edge.ends, part)"),
]

# Weights (rule 4), and stored triangles.
WEIGHTS = [
    Mutant("outside the hull the farthest edge counts", MESH, "distance < nearest[0]:", "distance > nearest[0]:"),
    Mutant("outside the hull the first edge counts", MESH, "nearest is None or distance < nearest[0]:", "nearest is None:"),
    Mutant("weights on an edge are between its ends only", MESH, "for (before, i), (after, j) in zip(feet, feet[1:]):", "for (before, i), (after, j) in [(feet[0], feet[-1])]:"),
    Mutant("on an edge the nearer condition is played", MESH, "share = (part - before) / (after - before)", "share = float(part - before > after - part)"),
    Mutant("in a triangle the nearest condition is played", MESH, "return {i: max(part, 0.0) for i, part in zip(triangle, parts)}, None", "return {i: float(part == max(parts)) for i, part in zip(triangle, parts)}, None"),
    Mutant("conditions with a weight of 1e-12 are mixed", PLAYING, "LEFT_OUT = 1e-12", "LEFT_OUT = 0.0"),
    Mutant("conditions with a weight of 1e-9 are left out", PLAYING, "LEFT_OUT = 1e-12", "LEFT_OUT = 1e-9"),
    Mutant("weights are scaled up for what is left out", PLAYING, "kept = sorted((i for i, w in weights.items() if w > LEFT_OUT), key=lambda i: self.mesh.points[i])", "kept = sorted((i for i, w in weights.items() if w > LEFT_OUT), key=lambda i: self.mesh.points[i])\n        weights = {i: weights[i] / sum(weights[j] for j in kept) for i in kept}",
           "what is left out is at most 2e-12 of the sum, and numbers are compared within 1e-8"),
    Mutant("sets are mixed in descending order", PLAYING, "key=lambda i: self.mesh.points[i])\n        values", "key=lambda i: self.mesh.points[i], reverse=True)\n        values"),
    Mutant("sets are mixed in the order of their forces", PLAYING, "key=lambda i: self.mesh.points[i])\n        values", "key=lambda i: self.mesh.points[i][::-1])\n        values"),
    Mutant("sets are mixed in the order of the manifest", PLAYING, "key=lambda i: self.mesh.points[i])\n        values", "key=lambda i: i)\n        values"),
    Mutant("levels are mixed in power", PLAYING, "level = sum(weights[i] * self.levels[i] for i in kept)", "level = sum(weights[i] * self.levels[i] ** 2 for i in kept) ** 0.5"),
    Mutant("levels of silent conditions are left out", PLAYING, "level = sum(weights[i] * self.levels[i] for i in kept)", "heard = [i for i in kept if self.levels[i]] or kept\n        level = sum(weights[i] * self.levels[i] for i in heard) / sum(weights[i] for i in heard)"),
    Mutant("stored triangles are not used", PLAYING, 'if representation.get("triangles"):', "if False:"),
    Mutant("with stored triangles values are grouped", PLAYING, "self.axes = (StoredAxis(speeds), StoredAxis(forces))", "self.axes = (Axis(speeds, True), Axis(forces, True))"),
    Mutant("stored triangles are as they turn", MESH, "return (a, b, c) if orient(exact[a], exact[b], exact[c]) > 0 else (a, c, b)", "return (a, b, c)",
           "weights do not depend on the sense of a triangle, and no inner edge is nearer than the hull"),
    Mutant("conditions belong to an edge with stored triangles too", MESH, "            self.edges = [Edge(ends, [(0.0, ends[0]), (1.0, ends[1])]) for ends in self.outer_edges()]", "            self.find_hull()"),
    Mutant("axes of stored triangles are not scaled", AXES, "        self.complete = greatest > 0\n        self.scale = greatest or 1.0", "        self.complete = greatest > 0\n        self.scale = 1.0"),
]

# Outside the conditions.
OUTSIDE = [
    Mutant("v / v0 may be below 1/16", LAW, "LEAST_RATIO, MOST_RATIO = 1 / 16, 8.0", "LEAST_RATIO, MOST_RATIO = 1 / 64, 8.0"),
    Mutant("v / v0 may be above 8", LAW, "LEAST_RATIO, MOST_RATIO = 1 / 16, 8.0", "LEAST_RATIO, MOST_RATIO = 1 / 16, 32.0"),
    Mutant("the ratio of speeds is not clamped before its powers", PLAYING, "ratio_v = clamp(ratio_v)", "ratio_v = max(ratio_v, 1e-9)"),
    Mutant("the ratio of speeds is not clamped for the level", PLAYING, "        ratio_v = clamp(ratio_v)\n        factor = clamp(power(ratio_v, a))\n", "        factor = clamp(power(clamp(ratio_v), a))\n"),
    Mutant("the ratio of speeds is not clamped for frequencies", PLAYING, "        ratio_v = clamp(ratio_v)\n        factor = clamp(power(ratio_v, a))\n", "        factor = clamp(power(ratio_v, a))\n        ratio_v = clamp(ratio_v)\n"),
    Mutant("the factor of frequencies is not clamped", PLAYING, "factor = clamp(power(ratio_v, a))", "factor = power(ratio_v, a)"),
    Mutant("the ratio of forces is clamped", PLAYING, "ratio_v = clamp(ratio_v)", "ratio_v, ratio_f = clamp(ratio_v), clamp(ratio_f)"),
    Mutant("the exponents of speed and force are exchanged", PLAYING, "power(ratio_v, b) * power(ratio_f, c)", "power(ratio_v, c) * power(ratio_f, b)"),
    Mutant("the level does not follow the force", PLAYING, "power(ratio_v, b) * power(ratio_f, c)", "power(ratio_v, b)"),
    Mutant("the level follows the factor of frequencies", PLAYING, "power(ratio_v, b) * power(ratio_f, c)", "power(factor, b) * power(ratio_f, c)"),
    Mutant("the sign of a speed counts", PLAYING, "        speed = abs(speed)\n", ""),
    Mutant("a force of 0 has the ratio 1", LAW, "    if base == 0:\n", "    if base == 0:\n        return 1.0\n    if base == 0:\n",
           "without a force a player is silent, and no case has numbers"),
    Mutant("the ceiling is 5 times the largest level", LAW, "CEILING = 4.0", "CEILING = 5.0"),
    Mutant("the ceiling is 4 times the level of the mix", PLAYING, "level = scaled(level, max(self.levels),", "level = scaled(level, level,"),
    Mutant("the ceiling is 4 times the smallest level", PLAYING, "level = scaled(level, max(self.levels),", "level = scaled(level, min(self.levels),"),
    Mutant("there is no ceiling", LAW, "return max(level, min(level * factor, CEILING * largest))", "return level * factor"),
    Mutant("the ceiling reduces a level that is raised", LAW, "return max(level, min(level * factor, CEILING * largest))", "return min(level * factor, CEILING * largest)",
           "a mix is not above the largest level, and so not above 4 times it"),
    Mutant("the ceiling is applied before the force", PLAYING, "level = scaled(level, max(self.levels), power(ratio_v, b) * power(ratio_f, c))", "level = scaled(scaled(level, max(self.levels), power(ratio_v, b)), max(self.levels), power(ratio_f, c))"),
    Mutant("the law of the asset has no effect", LAW, '    if "law" in manifest:', "    if False:"),
    Mutant("an absent contact is a finger", LAW, 'manifest.get("contact", "unknown")', 'manifest.get("contact", "finger")'),
    Mutant("tools: another b", LAW, "return 0.0, 0.43, 0.07", "return 0.0, 0.75, 0.07"),
    Mutant("tools: another c", LAW, "return 0.0, 0.43, 0.07", "return 0.0, 0.43, 0.5"),
    Mutant("fingers: b of a velocity is 0", LAW, '{"velocity": 1.0, "acceleration": 2.0}', '{"acceleration": 2.0}'),
    Mutant("fingers: b of an acceleration is 1", LAW, '{"velocity": 1.0, "acceleration": 2.0}', '{"velocity": 1.0, "acceleration": 1.0}'),
    Mutant("fingers: b of a force is 1", LAW, ".get(quantity, 0.0), 1.0", ".get(quantity, 1.0), 1.0"),
    Mutant("tools: b depends on the quantity", LAW, '    if contact == "tool":\n        return 0.0, 0.43, 0.07', '    if contact == "tool":\n        return 0.0, {"velocity": 1.0, "acceleration": 2.0}.get(quantity, 0.43), 0.07'),
    Mutant("contact unknown: another b", LAW, "return 0.0, 0.75, 0.5", "return 0.0, 0.43, 0.5"),
    Mutant("contact unknown: another c", LAW, "return 0.0, 0.75, 0.5", "return 0.0, 0.75, 0.25"),
    Mutant("a map follows both factors", PLAYING, 'if self.model["id"] in FOLLOW_THE_MOTION else', "if False else"),
    Mutant("noise that is moved keeps its magnitude", PLAYING, "density = 1.0 if self.model[\"id\"] in SUMS_OF_SINUSOIDS else factor**-0.5", "density = 1.0"),
    Mutant("lines that are moved lose magnitude", PLAYING, "density = 1.0 if self.model[\"id\"] in SUMS_OF_SINUSOIDS else factor**-0.5", "density = factor**-0.5"),
]

# The default condition.
DEFAULT = [
    Mutant("the default condition is always the first", PLAYING, "if not heard or heard[0] == 0:", "if True:"),
    Mutant("the default condition is the strongest", PLAYING, "if not heard or heard[0] == 0:", "if not heard:"),
    Mutant("an element without a force may be the default", PLAYING, "and (force is None or force > 0)", ""),
    Mutant("an element at rest may be the default", PLAYING, "return (speed is None or speed >= SLIDES_MM_S) and", "return"),
    Mutant("an element below 1 mm/s is silent", PLAYING, "SLIDES_MM_S = 0.5", "SLIDES_MM_S = 1.0"),
    Mutant("an element whose level is 0 may be the default", PLAYING, "if level > 0 and slides(*motion)]", "if slides(*motion)]"),
    Mutant("an element whose speed is absent is silent", PLAYING, "(speed is None or speed >= SLIDES_MM_S)", "((speed or 0.0) >= SLIDES_MM_S)"),
    Mutant("an element whose force is absent is silent", PLAYING, "(force is None or force > 0)", "((force or 0.0) > 0)"),
    Mutant("of equally strong elements the last is the default", PLAYING, "key=lambda i: (self.levels[i], -i)", "key=lambda i: (self.levels[i], i)"),
    Mutant("the default condition is the weakest", PLAYING, "chosen = max(heard, key=lambda i: (self.levels[i], -i))", "chosen = min(heard, key=lambda i: (self.levels[i], -i))"),
]

# Mixing.
MIX = [
    Mutant("AR: coefficients are mixed", MIXING, "    return [filter_of(frequencies), sets[0][1]]", "    return [mean(padded, weights), sets[0][1]]"),
    Mutant("AR: filters of other rates are mixed", MIXING, '    require_equal(sets, 1, "model rates")\n', ""),
    Mutant("AR: filters of other orders are not mixed", MIXING, "    order = max(len(values[0]) for values in sets)\n    padded", '    require_lengths(sets, "orders")\n    order = max(len(values[0]) for values in sets)\n    padded'),
    Mutant("MFCC: lists of other lengths are mixed", MIXING, '    require_lengths(sets, "lengths")\n', "    shortest = min(len(values[0]) for values in sets)\n    sets = [[values[0][:shortest], *values[1:]] for values in sets]\n"),
    Mutant("MFCC: other bands are mixed", MIXING, '    require_equal(sets, 1, "bands")\n', ""),
    Mutant("MFCC: other inverses are mixed", MIXING, '    require_equal(sets, 2, "inverses")\n', ""),
    Mutant("bands: other numbers of knots are mixed", MIXING, '    require_lengths(sets, "numbers of knots")\n', "    shortest = min(len(values[0]) for values in sets)\n    sets = [[values[0][:shortest], *values[1:]] for values in sets]\n"),
    Mutant("bands: other steps are mixed", MIXING, '    require_equal(sets, 1, "steps")\n', ""),
    Mutant("bands: other layouts are mixed", MIXING, '    require_equal(sets, 2, "layouts")\n', ""),
    Mutant("bands: only sets of all conditions with equal steps are mixed", PLAYING, "        values = mix(self.model[\"id\"], [self.sets[i] for i in kept], [weights[i] for i in kept])", "        if self.model[\"id\"] == \"org.htex.bands\":\n            mix(self.model[\"id\"], self.sets, [1 / len(self.sets)] * len(self.sets))\n        values = mix(self.model[\"id\"], [self.sets[i] for i in kept], [weights[i] for i in kept])"),
    Mutant("speak: more than 64 lines together are mixed", MIXING, "if len(frequencies) > MOST_LINES:", "if False:"),
    Mutant("speak: 64 lines together are refused", MIXING, "if len(frequencies) > MOST_LINES:", "if len(frequencies) >= MOST_LINES:"),
    Mutant("speak: amplitudes of lines together are times the weight", MIXING, "a * weight**0.5 for", "a * weight for"),
    Mutant("speak: lines of equal numbers are put together", MIXING, "if all(len(values[0]) == len(sets[0][0]) for values in sets):", "if False:"),
    Mutant("speak: random_phase of equal numbers is that of the first", MIXING, "        return mix_scalars(sets, weights)\n    frequencies", "        return [*mix_scalars(sets, weights)[:2], sets[0][2]]\n    frequencies"),
    Mutant("speak: random_phase of lines together is mixed", MIXING, "return [frequencies, amplitudes, sets[0][2]]", "return [frequencies, amplitudes, mean([values[2] for values in sets], weights)]"),
    Mutant("speak: random_phase of lines together is that of the last", MIXING, "return [frequencies, amplitudes, sets[0][2]]", "return [frequencies, amplitudes, sets[-1][2]]"),
    Mutant("speak: equal numbers of lines in two sets are enough", MIXING, "if all(len(values[0]) == len(sets[0][0]) for values in sets):", "if len(sets) < 3 and all(len(values[0]) == len(sets[0][0]) for values in sets):"),
    Mutant("map: the first set is played", MIXING, "if weight >= max(weights) - 1e-9", "if True"),
    Mutant("map: the set of the largest weight is played, without 1e-9", MIXING, "max(weights) - 1e-9", "max(weights)"),
    Mutant("map: a set within 1e-6 of the largest weight is played", MIXING, "max(weights) - 1e-9", "max(weights) - 1e-6"),
    Mutant("map: of equal weights the last set is played", MIXING, "return next(values for values, weight in zip(sets, weights)", "return next(values for values, weight in reversed(list(zip(sets, weights)))"),
    Mutant("ARMA: filters of other rates are mixed", MIXING, '    require_equal(sets, 2, "model rates")\n', ""),
    Mutant("ARMA: lower orders with a zero on the circle are mixed", MIXING, '        raise Refusal("a zero on the unit circle, and another order")\n', "        pass\n"),
    Mutant("ARMA: other orders are not mixed", MIXING, "    order = max(len(lines) for lines in sets)\n", '    if any(len(lines) != len(sets[0]) for lines in sets):\n        raise Refusal("other orders")\n    order = max(len(lines) for lines in sets)\n'),
    Mutant("ARMA: lines are padded with pi", MIXING, "    return mean([lines if len(lines) == order else padded_lines(lines, order) for lines in sets], weights)", "    return mean([lines + [3.1415927410125732] * (order - len(lines)) for lines in sets], weights)"),
]

# Shapes of the models.
SHAPE = [
    Mutant("the RMS of a spectrum is without the window's width", SHAPES, "rms = math.sqrt(float(np.sum(on_grid**2)) / 3)", "rms = math.sqrt(float(np.sum(on_grid**2)) / 2)"),
    Mutant("the band's edges are outside it", SHAPES, "return (f >= self.low) & (f <= self.high)", "return (f > self.low) & (f < self.high)"),
    Mutant("there is magnitude outside the band", SHAPES, "return np.where(band.inside(f), shape(clamped), 0.0)", "return shape(clamped)"),
    Mutant("AR: the signs of the coefficients are others", SHAPES, "response = 1 - np.exp", "response = 1 + np.exp"),
    Mutant("AR: there is magnitude above R/2", SHAPES, "return np.where(f <= rate / 2, 1 / np.abs(response), 0.0)", "return 1 / np.abs(response)"),
    Mutant("AR: an unstable filter is played", SHAPES, '        raise Refusal("the filter is not stable")\n', "        pass\n"),
    Mutant("ARMA: lines of poles that do not ascend are played", SHAPES, '        raise Refusal("the lines of the poles do not ascend between 0 and pi")\n', "        pass\n"),
    Mutant("ARMA: lines of zeros that descend are played", SHAPES, '        raise Refusal("the lines of the zeros descend")\n', "        pass\n"),
    Mutant("ARMA: equal lines of zeros are refused", SHAPES, "if any(a > b for a, b in zip(zeros, zeros[1:])):", "if any(a >= b for a, b in zip(zeros, zeros[1:])):"),
    Mutant("ARMA: there is magnitude above R/2", SHAPES, "return np.where(f <= rate / 2, np.sqrt(power), 0.0)", "return np.sqrt(power)"),
    Mutant("ARMA: even and odd orders are one", SHAPES, "    if len(lines) % 2 == 0:\n        return factors[0] * np.cos(turn / 2) ** 2 + factors[1] * np.sin(turn / 2) ** 2\n    return (factors[0] + 4 * factors[1] * np.sin(turn) ** 2) / 4", "    return factors[0] * np.cos(turn / 2) ** 2 + factors[1] * np.sin(turn / 2) ** 2"),
    Mutant("map: a wave of two pixels counts twice", SHAPES, "np.where(2 * k == width, 1, 2)", "2"),
    Mutant("map: waves are those of the pixels", SHAPES, "* gain**2 * waves *", "* waves *"),
    Mutant("map: waves outside the band count", SHAPES, " * ((lines >= band.low) & (lines <= band.high))", ""),
    Mutant("map: rows are not averaged in power", SHAPES, "waves = np.mean(np.abs(np.fft.fft(rows)[:, k]) ** 2, axis=0) / width**2", "waves = np.abs(np.mean(np.fft.fft(rows)[:, k], axis=0)) ** 2 / width**2"),
    Mutant("map: the RMS may be any", SHAPES, "abs(rms - own) > 1e-6 * own", "False"),
    Mutant("lines: the lobe ends at one bin", SHAPES, "heights = np.where(np.abs(d) >= 2, 0.0, window_lobe(d))", "heights = np.where(np.abs(d) >= 1, 0.0, window_lobe(d))"),
    Mutant("lines: the lobe has no end", SHAPES, "heights = np.where(np.abs(d) >= 2, 0.0, window_lobe(d))", "heights = window_lobe(d)"),
    Mutant("lines: heights are added", SHAPES, "return np.sqrt(np.sum(heights**2, axis=1)) / math.sqrt(power)", "return np.sum(np.abs(heights), axis=1) / math.sqrt(power)"),
    Mutant("lines: a line at the band's edge counts whole", SHAPES, "    if frequency - first >= 4 * BIN and last - frequency >= 4 * BIN:\n        return 1.0\n", "    return 1.0\n"),
    Mutant("lines: of two bins the lower one is nearest", SHAPES, "math.floor(frequency / BIN + 0.5) * BIN", "math.ceil(frequency / BIN - 0.5) * BIN"),
    Mutant("lines: three bins are read on either side", SHAPES, "bins = nearest + BIN * np.arange(-4, 5)", "bins = nearest + BIN * np.arange(-3, 4)"),
    Mutant("lines: lines outside the band count in the level", SHAPES, "for f, a in zip(values[0], values[1]) if band.low <= f <= band.high]", "for f, a in zip(values[0], values[1])]"),
    Mutant("lines: as many amplitudes as frequencies are not needed", PLAYING, '    if model["id"] == "org.htex.speak" and len(values[0]) != len(values[1]):\n        raise Refusal("as many amplitudes as frequencies")\n', ""),
    Mutant("beta: no limit at the lower edge", SHAPES, "a, b = (1.25 if alpha < 1 else 0.0), (1.25 if beta < 1 else 0.0)", "a, b = (1e-9 if alpha < 1 else 0.0), (1.25 if beta < 1 else 0.0)"),
    Mutant("beta: no limit at the upper edge", SHAPES, "a, b = (1.25 if alpha < 1 else 0.0), (1.25 if beta < 1 else 0.0)", "a, b = (1.25 if alpha < 1 else 0.0), (1e-9 if beta < 1 else 0.0)"),
    Mutant("beta: both edges are limited always", SHAPES, "a, b = (1.25 if alpha < 1 else 0.0), (1.25 if beta < 1 else 0.0)", "a, b = 1.25, 1.25"),
    Mutant("beta: 0 to the power 0 is 0", SHAPES, "return np.zeros_like(base) if exponent == 0 else exponent * np.log(base)", "return np.where(base == 0, -np.inf, 0.0) if exponent == 0 else exponent * np.log(base)"),
    Mutant("slopes: the orders are exchanged", SHAPES, "peak, high_pass, low_pass = values", "peak, low_pass, high_pass = values"),
    Mutant("bands: layout 0.5 is within the band", SHAPES, "if layout < 0.5:", "if layout <= 0.5:"),
    Mutant("bands: knots lie from edge to edge in ln f", SHAPES, "x = (count + 1) * np.log(f / band.low) / math.log(band.high / band.low)", "x = 1 + (count - 1) * np.log(f / band.low) / math.log(band.high / band.low)"),
    Mutant("bands: no 20 Hz are added", SHAPES, "x = 1 + (count - 1) * np.log((f + 20) / (band.low + 20)) / math.log((band.high + 20) / (band.low + 20))", "x = 1 + (count - 1) * np.log(f / band.low) / math.log(band.high / band.low)"),
    Mutant("bands: the step is of the power", SHAPES, "np.arange(1, count + 1), knots) / 20)", "np.arange(1, count + 1), knots) / 10)"),
    Mutant("MFCC: halves are rounded down", SHAPES, "return math.floor(x + 0.5)", "return math.ceil(x - 0.5)"),
    Mutant("MFCC: edges are even in ln f", SHAPES, "edges = 700 * (10 ** (mel / 2595) - 1)", "edges = np.exp(np.linspace(math.log(band.low), math.log(band.high), count + 2))"),
    Mutant("MFCC: the DCT is not orthonormal", SHAPES, 'idct(padded, norm="ortho")', "idct(padded)"),
    Mutant("MFCC: coefficients above the bands count", SHAPES, "padded[: min(count, len(cepstrum))] = cepstrum[:count]", "padded[: min(count, len(cepstrum))] = cepstrum[:count]\n    padded[1] += sum(cepstrum[count:])"),
    Mutant("MFCC: inverse 0 is not clipped", SHAPES, "power = np.maximum(np.linalg.pinv(weights, rcond=share) @ energies, 0.0)", "power = np.abs(np.linalg.pinv(weights, rcond=share) @ energies)"),
    Mutant("MFCC: inverse 1 is not regularised", SHAPES, "1e-3 * np.eye(size)", "1e-9 * np.eye(size)"),
    Mutant("MFCC: inverse 2 does not divide by the weights", SHAPES, "energies[some] / sums[some])", "energies[some])"),
    Mutant("MFCC: inverse 3 is linear in f", SHAPES, "np.log(edges[1:-1][some]), logs[some] - np.log(sums[some]), np.log(grid)", "edges[1:-1][some], logs[some] - np.log(sums[some]), grid"),
    Mutant("MFCC: inverse 3 is constant beyond the apexes", SHAPES, "power += first * np.minimum(at - x[0], 0) + last * np.maximum(at - x[-1], 0)", "pass"),
    Mutant("MFCC: inverse 3 has any slope", SHAPES, "/ (x[i + 1] - x[i]), -8, 8)", "/ (x[i + 1] - x[i]), -80, 80)"),
    Mutant("MFCC: magnitudes between grid points are in decibels", SHAPES, "    amplitudes = np.sqrt(power)\n    return normed(lambda f: np.interp(f, band.grid, amplitudes), band)", "    amplitudes = np.sqrt(power)\n    return normed(lambda f: np.exp(np.interp(f, band.grid, np.log(amplitudes + 1e-300))), band)"),
    Mutant("ranges of parameters are not checked", PLAYING, '            raise Refusal(f"{field[\'name\']} is out of range")\n', "            pass\n"),
    Mutant("lengths of lists are not checked", PLAYING, '            raise Refusal(f"too many {field[\'name\']}")\n', "            pass\n"),
    Mutant("another major version of a model is played", PLAYING, '            raise Refusal("another major version of the model")\n', "            pass\n"),
    Mutant("fields are in the order in which they are stored", PLAYING, "[block[stored.index(field[\"name\"])] for field in model[\"fields\"]]", "list(block)"),
]

MUTANTS = [*AXIS, *TRIANGULATION, *EDGES, *WEIGHTS, *OUTSIDE, *DEFAULT, *MIX, *SHAPE]
