"""Steps of Runge-Kutta methods over blocks of 8 states, as LLVM IR: one text for every program and machine.

    void nb_rk4  (job, lanes, work, double t1, double h, int64 steps, int64 begin, int64 end)
    void nb_dopri(job, lanes, work, double t1, double least, int64 attempts, int64 begin, int64 end)

`job` holds int64 numbers and addresses, in the order of `JOB`; `lanes` the addresses of what each block has, in the
order of `LANES_OF`; `work` is the memory of one thread: ten times y, then the outputs of a program.
Fixed steps are the classical method of order 4; adaptive ones Dormand-Prince 5(4), first same as last, with a time and
a step for every lane: lanes that accept go on, the others try again, those that are there wait for the rest of their
block.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from functools import cache

from nullbody.kernels.loops import LANES, VECTOR, Loops

__all__ = ["JOB", "LANES_OF", "march_ir"]

#: What the numbers of `job` are.
JOB = (
    "rate",
    "corrected",
    "inputs",
    "size",
    "guards",
    "corrections",
    "time",
    "limits",
    "watched",
    "watch",
    "rtol",
    "atol",
)

#: What the arrays of `lanes` are, block after block.
LANES_OF = ("inputs", "side", "status", "time", "step", "accepted", "refused")

_OLD, _NEW, _SUM, _FIRST = 0, 1, 2, 3  # places in `work`, in units of y
_OUT = 10  # where the outputs begin

_RATES: tuple[Mapping[int, Fraction], ...] = tuple(
    {j: Fraction(text) for j, text in enumerate(row.split()) if text != "0"}
    for row in (
        "1/5",
        "3/40 9/40",
        "44/45 -56/15 32/9",
        "19372/6561 -25360/2187 64448/6561 -212/729",
        "9017/3168 -355/33 46732/5247 49/176 -5103/18656",
        "35/384 0 500/1113 125/192 -2187/6784 11/84",
    )
)
_TIMES = (Fraction(1, 5), Fraction(3, 10), Fraction(4, 5), Fraction(8, 9), Fraction(1), Fraction(1))
_ERRORS = {
    j: Fraction(text)
    for j, text in enumerate(["71/57600", "0", "-71/16695", "71/1920", "-17253/339200", "22/525", "-1/40"])
    if text != "0"
}
_SAFETY, _LEAST_FACTOR, _LARGEST_FACTOR = 0.9, 0.2, 5.0


@cache
def march_ir() -> str:
    """Both functions and what they need, as LLVM IR for any machine."""
    suffix = LANES.suffix
    declared = [
        f"declare {VECTOR} @llvm.fabs.{suffix}({VECTOR})",
        f"declare {VECTOR} @llvm.sqrt.{suffix}({VECTOR})",
        f"declare {VECTOR} @llvm.pow.{suffix}({VECTOR}, {VECTOR})",
    ]
    return "\n".join([*declared, _guards(), _function("nb_rk4", _fixed), _function("nb_dopri", _adaptive)])


def _guards() -> str:
    """The number of the first guard that a lane breaks, where it has broken none: g side > 1, others |g| < limit."""
    ir = Loops()
    ir.write(f"%code.at = alloca {LANES.integer}, align 64")
    ir.store_whole("%code", "%code.at")
    first = ir.load("%out", "%size")
    right = ir.compare("ogt", ir.mul(first, "%side"), 1.0)
    watched = ir.compare("une", "%side", 0.0)
    wrong = ir.both_true(watched, ir.untrue(right))
    _note(ir, wrong, "1")
    start, others = ir.emit("add i64 %size, 1"), ir.emit("sub i64 %count, 1")

    def look(k: str) -> None:
        value = ir.intrinsic("fabs", ir.load("%out", ir.emit(f"add i64 {start}, {k}")))
        limit = ir.spread(ir.load("%limits", k, "double"))
        _note(ir, ir.untrue(ir.compare("olt", value, limit)), ir.emit(f"add i64 {k}, 2"))

    ir.loop(others, look)
    result = ir.load_whole("%code.at")
    kind = LANES.integer
    head = f"ptr %out, i64 %size, i64 %count, ptr %limits, {VECTOR} %side, {kind} %code"
    return f"""define internal {kind} @nbt.guards({head}) nounwind {{
{ir}
  ret {kind} {result}
}}"""


def _note(ir: Loops, wrong: str, number: str) -> None:
    """Write a number to %code.at in lanes that are wrong and have none yet."""
    code = ir.load_whole("%code.at")
    fresh = ir.both_true(wrong, ir.zero_whole(code))
    ir.store_whole(ir.choose_whole(fresh, ir.spread_whole(number), code), "%code.at")


class _Block:
    """What both methods do with the block at hand: its memory, and calls of the programs."""

    def __init__(self, ir: Loops) -> None:
        self.ir = ir
        self.job = {
            name: ir.load("%job", k, "ptr" if name in ("rate", "corrected", "limits") else "i64")
            for k, name in enumerate(JOB[: JOB.index("watch")])
        }
        self.size = self.job["size"]
        self.region = {k: self._region(k) for k in range(_OUT + 1)}
        self.correcting = ir.emit(f"icmp sgt i64 {self.job['corrections']}, 0")

    def _region(self, k: int) -> str:
        return self.ir.place("%work", self.ir.emit(f"mul i64 {self.size}, {k}"))

    def lanes(self) -> None:
        """Addresses of the block."""
        ir = self.ir
        self.at = {}
        for k, name in enumerate(LANES_OF):
            array = ir.load("%lanes", k, "ptr")
            skip = "%block" if name != "inputs" else ir.emit(f"mul i64 %block, {self.job['inputs']}")
            self.at[name] = ir.place(array, skip)
        self.side = ir.load(self.at["side"])

    def evaluate(self, program: str, time: str, code: str) -> str:
        """Call a program at the inputs of the block; the code of the guards that it breaks."""
        ir, job, out = self.ir, self.job, self.region[_OUT]
        timed = ir.emit(f"icmp sge i64 {job['time']}, 0")
        ir.where(timed, lambda: ir.store(time, self.at["inputs"], job["time"]))
        ir.write(f"call void {job[program]}(ptr {self.at['inputs']}, ptr {out}, i64 1)")
        kind = LANES.integer
        return ir.emit(
            f"call {kind} @nbt.guards(ptr {out}, i64 {self.size}, i64 {job['guards']}, ptr {job['limits']}, "
            f"{VECTOR} {self.side}, {kind} {code})"
        )

    def watch(self, where: str) -> None:
        """Write g + 3 to %code.at in lanes where the guard that is watched has grown beyond what is wanted."""
        ir, job = self.ir, self.job

        def look() -> None:
            value = ir.intrinsic("fabs", ir.load(self.region[_OUT], ir.emit(f"add i64 {self.size}, {job['watched']}")))
            limit = ir.spread(ir.load("%job", JOB.index("watch"), "double"))
            over = ir.both_true(where, ir.compare("ogt", value, limit))
            _note(ir, over, ir.emit(f"add i64 {job['guards']}, 3"))

        ir.where(ir.emit(f"icmp sge i64 {job['watched']}, 0"), look)

    def copied(self, k: str, source: str, *targets: str) -> str:
        """Component k of y from one place to others."""
        value = self.ir.load(source, k)
        for target in targets:
            self.ir.store(value, target, k)
        return value

    def correction(self, k: str) -> str:
        """Component k of the correction."""
        ir = self.ir
        start = ir.emit(f"add i64 {self.size}, {self.job['guards']}")
        return ir.load(self.region[_OUT], ir.emit(f"add i64 {start}, {k}"))

    def correct(self, *places: str) -> None:
        """y + correction, where the program has one."""
        ir = self.ir

        def add() -> None:
            def one(k: str) -> None:
                step = self.correction(k)
                for place in places:
                    ir.store(ir.add(ir.load(place, k), step), place, k)

            ir.loop(self.job["corrections"], one)

        ir.where(self.correcting, add)


def _function(name: str, body: Callable[[Loops, _Block], None]) -> str:
    """A function over blocks around the steps of one."""
    ir = Loops()
    ir.write(f"%code.at = alloca {LANES.integer}, align 64")
    ir.write(f"%sum.at = alloca {VECTOR}, align 64")
    block = _Block(ir)
    ir.lines.append("  br label %blocks\nblocks:\n  %block = phi i64 [%begin, %0], [%block.next, %block.end]")
    ir.lines.append("  %more = icmp slt i64 %block, %end\n  br i1 %more, label %inside, label %finish\ninside:")
    block.lanes()
    body(ir, block)
    ir.lines.append("  br label %block.end\nblock.end:\n  %block.next = add i64 %block, 1\n  br label %blocks")
    head = "ptr %job, ptr %lanes, ptr %work, double %a, double %b, i64 %count, i64 %begin, i64 %end"
    return f"define void @{name}({head}) nounwind alignstack(64) {{\n{ir}\nfinish:\n  ret void\n}}"


def _fixed(ir: Loops, block: _Block) -> None:
    """Steps of the classical method: y + h/6 (k1 + 2 k2 + 2 k3 + k4); lanes that break a guard stay where they were."""
    h = ir.spread("%b")
    half, sixth = ir.mul(h, 0.5), ir.mul(h, 1 / 6)

    def step(_: str) -> None:
        running = _waiting(ir, block, half)
        ir.where(ir.any_lane(running), lambda: _one_fixed(ir, block, h, half, sixth))

    ir.loop("%count", step)


def _one_fixed(ir: Loops, block: _Block, h: str, half: str, sixth: str) -> None:
    y, out, size = block.at["inputs"], block.region[_OUT], block.size
    old, new, total = (block.region[k] for k in (_OLD, _NEW, _SUM))
    status, t = ir.load_whole(block.at["status"]), ir.load(block.at["time"])
    running = _waiting(ir, block, half)
    ir.store_whole(block.evaluate("corrected", t, LANES.whole(0)), "%code.at")
    block.watch(running)
    code = ir.load_whole("%code.at")
    ir.loop(size, lambda k: block.copied(k, y, old, new))
    block.correct(new)

    def stage(k: str, weight: float | None, length: str) -> None:
        rate = ir.load(out, k)
        part = rate if weight is None else ir.add(ir.load(total, k), ir.mul(rate, weight))
        ir.store(part, total, k)
        ir.store(ir.add(ir.load(new, k), ir.mul(length, rate)), y, k)

    ir.loop(size, lambda k: stage(k, None, half))
    middle = ir.add(t, half)
    code = block.evaluate("rate", middle, code)
    ir.loop(size, lambda k: stage(k, 2.0, half))
    code = block.evaluate("rate", middle, code)
    ir.loop(size, lambda k: stage(k, 2.0, h))
    end = ir.add(t, h)
    code = block.evaluate("rate", end, code)
    ir.store_whole(code, "%code.at")
    beyond = ir.emit(f"add i64 {block.job['guards']}, 1")

    def last(k: str) -> None:
        rates = ir.add(ir.load(total, k), ir.load(out, k))
        value = ir.add(ir.load(new, k), ir.mul(sixth, rates))
        ir.store(value, y, k)
        _note(ir, ir.compare("uno", ir.op("fsub", value, value), 0.0), beyond)

    ir.loop(size, last)
    code = ir.load_whole("%code.at")
    good = ir.both_true(running, ir.zero_whole(code))
    ir.loop(size, lambda k: ir.store(ir.choose(good, ir.load(y, k), ir.load(old, k)), y, k))
    ir.store(ir.choose(good, end, t), block.at["time"])
    ir.store_whole(ir.choose_whole(running, code, status), block.at["status"])
    ir.store_whole(ir.whole_sum(ir.load_whole(block.at["accepted"]), ir.counted(good)), block.at["accepted"])


def _adaptive(ir: Loops, block: _Block) -> None:
    """Attempts until every lane is at t1 or has stopped, or as many as are allowed."""
    y, out, first = block.at["inputs"], block.region[_OUT], block.region[_FIRST]
    running = _waiting(ir, block)

    def begin() -> None:
        code = block.evaluate("corrected", ir.load(block.at["time"]), LANES.whole(0))
        stopped = ir.load_whole(block.at["status"])
        ir.store_whole(ir.choose_whole(_waiting(ir, block), code, stopped), block.at["status"])
        ir.loop(block.size, lambda k: block.copied(k, out, first))
        ir.loop(block.size, lambda k: block.copied(k, y, block.region[_OLD]))

        def attempt(_: str) -> None:
            still = _waiting(ir, block)
            ir.where(ir.any_lane(still), lambda: _one_attempt(ir, block))

        ir.loop("%count", attempt)
        ir.loop(block.size, lambda k: block.copied(k, block.region[_OLD], y))

    ir.where(ir.any_lane(running), begin)


def _waiting(ir: Loops, block: _Block, margin: str = LANES.constant(0.0)) -> str:
    """Lanes that have not stopped and are not at t1, less a margin."""
    alive = ir.zero_whole(ir.load_whole(block.at["status"]))
    end = ir.sub(ir.spread("%a"), margin)
    return ir.both_true(alive, ir.compare("olt", ir.load(block.at["time"]), end))


def _combined(ir: Loops, block: _Block, k: str, weights: Mapping[int, Fraction]) -> str:
    """Component k of sum_j w_j k_j."""
    total = ""
    for j, weight in weights.items():
        part = ir.mul(ir.load(block.region[_FIRST + j], k), float(weight))
        total = ir.add(total, part) if total else part
    return total


def _stages(ir: Loops, block: _Block, t: str, h: str) -> str:
    """Stages 2 to 7 from y; stage 7 stands at the new y. Returns the code of the guards."""
    y, out, old = block.at["inputs"], block.region[_OUT], block.region[_OLD]
    code = LANES.whole(0)
    for stage, (weights, time) in enumerate(zip(_RATES, _TIMES, strict=True)):
        last = stage == len(_RATES) - 1

        def place(k: str, weights: Mapping[int, Fraction] = weights, last: bool = last) -> None:
            value = ir.add(ir.load(old, k), ir.mul(h, _combined(ir, block, k, weights)))
            ir.store(value, y, k)
            if last:
                ir.store(value, block.region[_NEW], k)

        ir.loop(block.size, place)
        code = block.evaluate("corrected" if last else "rate", ir.add(t, ir.mul(h, float(time))), code)
        target = block.region[_FIRST + stage + 1]
        ir.loop(block.size, lambda k, target=target: block.copied(k, out, target))  # type: ignore[misc]
    return code


def _error(ir: Loops, block: _Block, h: str) -> str:
    """The root mean square of (local error, correction) against atol + rtol max(|y|, |y new|)."""
    old, new = block.region[_OLD], block.region[_NEW]
    rtol, atol = (ir.spread(ir.load("%job", JOB.index(name), "double")) for name in ("rtol", "atol"))
    ir.store(LANES.constant(0.0), "%sum.at")

    def add(k: str, error: str) -> None:
        a, b = ir.intrinsic("fabs", ir.load(old, k)), ir.intrinsic("fabs", ir.load(new, k))
        larger = ir.choose(ir.compare("ogt", a, b), a, b)
        ratio = ir.emit(f"fdiv {VECTOR} {error}, {ir.add(atol, ir.mul(rtol, larger))}")
        ir.store(ir.add(ir.load("%sum.at"), ir.mul(ratio, ratio)), "%sum.at")

    ir.loop(block.size, lambda k: add(k, ir.mul(h, _combined(ir, block, k, _ERRORS))))
    ir.where(block.correcting, lambda: ir.loop(block.job["corrections"], lambda k: add(k, block.correction(k))))
    count = ir.spread(ir.emit(f"sitofp i64 {block.size} to double"))
    return ir.intrinsic("sqrt", ir.emit(f"fdiv {VECTOR} {ir.load('%sum.at')}, {count}"))


def _one_attempt(ir: Loops, block: _Block) -> None:
    old, new, first, last = (block.region[k] for k in (_OLD, _NEW, _FIRST, _FIRST + 6))
    t, h_wanted, status = ir.load(block.at["time"]), ir.load(block.at["step"]), ir.load_whole(block.at["status"])
    running = _waiting(ir, block)
    left = ir.emit(f"fsub {VECTOR} {ir.spread('%a')}, {t}")
    final = ir.compare("oge", ir.mul(h_wanted, 1.0 + 1e-9), left)
    h = ir.choose(running, ir.choose(final, left, h_wanted), LANES.constant(0.0))
    code = _stages(ir, block, t, h)
    error = _error(ir, block, h)
    fine = ir.both_true(ir.zero_whole(code), ir.compare("ole", error, 1.0))
    accepted = ir.both_true(running, fine)
    block.correct(new)

    def keep(k: str) -> None:
        ir.store(ir.choose(accepted, ir.load(new, k), ir.load(old, k)), old, k)
        ir.store(ir.choose(accepted, ir.load(last, k), ir.load(first, k)), first, k)

    ir.loop(block.size, keep)
    ir.store(ir.choose(accepted, ir.choose(final, ir.spread("%a"), ir.add(t, h)), t), block.at["time"])
    tried = ir.mul(h, _factor(ir, error, code))
    longer = ir.both_true(ir.both_true(accepted, final), ir.compare("olt", tried, h_wanted))
    following = ir.choose(longer, h_wanted, tried)
    ir.store(ir.choose(running, following, h_wanted), block.at["step"])
    refused = ir.both_true(running, ir.untrue(fine))
    on_the_way = ir.both_true(running, ir.untrue(ir.both_true(accepted, final)))
    lost = ir.both_true(on_the_way, ir.compare("olt", following, ir.spread("%b")))
    small = ir.spread_whole(ir.emit(f"add i64 {block.job['guards']}, 2"))
    why = ir.choose_whole(ir.zero_whole(code), small, code)
    ir.store_whole(ir.choose_whole(lost, why, status), "%code.at")
    block.watch(accepted)
    ir.store_whole(ir.load_whole("%code.at"), block.at["status"])
    for name, truth in (("accepted", accepted), ("refused", refused)):
        ir.store_whole(ir.whole_sum(ir.load_whole(block.at[name]), ir.counted(truth)), block.at[name])


def _factor(ir: Loops, error: str, code: str) -> str:
    """By which the step changes: 0.9 error^(-1/5) within 0.2 and 5; 0.2 where the error is unknown."""
    wanted = ir.mul(ir.two("pow", error, LANES.constant(-0.2)), _SAFETY)
    least, largest = LANES.constant(_LEAST_FACTOR), LANES.constant(_LARGEST_FACTOR)
    bounded = ir.choose(ir.compare("olt", wanted, _LARGEST_FACTOR), wanted, largest)
    bounded = ir.choose(ir.compare("ogt", bounded, _LEAST_FACTOR), bounded, least)
    known = ir.both_true(ir.compare("ord", error, 0.0), ir.zero_whole(code))
    return ir.choose(known, bounded, least)
