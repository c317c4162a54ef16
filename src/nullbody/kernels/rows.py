"""Native code between arrays with a row for each state and blocks of 8 states, around a function over blocks.

    void nb_rows(function, job, source, target, int64 begin, int64 end)

For every block from begin to end: gather the input groups into `source` (inputs x 8), call the function, scatter
`target` (outputs x 8) into the output groups. Both stay in the first cache. Eight rows of eight columns are turned by
three rounds of exchanges; the last columns of a group are loaded and stored under a mask. Rows beyond the last state
are the last one again. A group of one number a state is stored as it is.

`job` holds int64 numbers: states, number of input groups, of output groups, then for every group (address, stride from
row to row in bytes, size). A stride of 0 is a group that all states share.
"""

from __future__ import annotations

from functools import cache

from nullbody.kernels.number import BLOCK, Number

__all__ = ["ROOM", "rows_ir", "rows_name"]

#: Columns that source and target need beyond their last one: a group is read and written eight columns at a time.
ROOM = BLOCK - 1

_ROUNDS = (1, 2, 4)


def rows_name(number: Number) -> str:
    """Name of the native function for one type of element."""
    return f"nb_rows{number.bits}"


@cache
def rows_ir(number: Number) -> str:
    """The function and what it needs, as LLVM IR for any machine."""
    wide = Number(BLOCK, number.bits)
    declared = (
        "declare i64 @llvm.smin.i64(i64, i64)",
        f"declare {wide.text} @llvm.masked.load.{wide.suffix}.p0(ptr, i32, {wide.truth}, {wide.text})",
        f"declare void @llvm.masked.store.{wide.suffix}.p0({wide.text}, ptr, i32, {wide.truth})",
    )
    parts = (*declared, _gather(wide), _scatter(wide), _share(wide), _driver(wide))
    return "\n".join(parts)


def _turned(wide: Number, rows: list[str], tag: str) -> tuple[list[str], list[str]]:
    """Lines that turn an 8 x 8 matrix over, and the names of its new rows."""
    lines = []
    for distance in _ROUNDS:
        low = [k if not k & distance else BLOCK + k - distance for k in range(BLOCK)]
        high = [k + distance if not k & distance else BLOCK + k for k in range(BLOCK)]
        turned = list(rows)
        for i in (i for i in range(BLOCK) if not i & distance):
            j = i + distance
            for place, mask in ((i, low), (j, high)):
                name = f"%{tag}{distance}.{place}"
                order = ", ".join(f"i32 {k}" for k in mask)
                both = f"{wide.text} {rows[i]}, {wide.text} {rows[j]}"
                lines.append(f"  {name} = shufflevector {both}, <{BLOCK} x i32> <{order}>")
                turned[place] = name
        rows = turned
    return lines, rows


def _row_places(wide: Number) -> list[str]:
    """Where the rows of one block begin: %row0 to %row7."""
    lines = ["  %first = mul i64 %block, 8", "  %last = sub i64 %states, 1"]
    for j in range(BLOCK):
        lines += [
            f"  %wanted{j} = add i64 %first, {j}",
            f"  %there{j} = call i64 @llvm.smin.i64(i64 %wanted{j}, i64 %last)",
            f"  %offset{j} = mul i64 %there{j}, %stride",
            f"  %row{j} = getelementptr i8, ptr %array, i64 %offset{j}",
        ]
    return lines


def _columns(name: str, wide: Number, body: list[str]) -> str:
    """An internal function that goes through the columns of one group, eight at a time."""
    steps = ", ".join(f"i64 {k}" for k in range(BLOCK))
    lines = [
        f"define internal void @{name}(ptr %array, i64 %stride, i64 %size, i64 %states, i64 %block, ptr %lanes) "
        "nounwind {",
        "start:",
        *_row_places(wide),
        "  %some = icmp sgt i64 %size, 0",
        "  br i1 %some, label %columns, label %end",
        "columns:",
        "  %c = phi i64 [0, %start], [%next, %columns]",
        "  %left = sub i64 %size, %c",
        f"  %one = insertelement <{BLOCK} x i64> poison, i64 %left, i32 0",
        f"  %all = shufflevector <{BLOCK} x i64> %one, <{BLOCK} x i64> poison, <{BLOCK} x i32> zeroinitializer",
        f"  %mask = icmp slt <{BLOCK} x i64> <{steps}>, %all",
        *(f"  %at{j} = getelementptr {wide.element}, ptr %row{j}, i64 %c" for j in range(BLOCK)),
        "  %lane0 = mul i64 %c, 8",
        *(f"  %lane{k} = add i64 %lane0, {BLOCK * k}" for k in range(1, BLOCK)),
        *(f"  %to{k} = getelementptr {wide.element}, ptr %lanes, i64 %lane{k}" for k in range(BLOCK)),
        *body,
        f"  %next = add i64 %c, {BLOCK}",
        "  %more = icmp slt i64 %next, %size",
        "  br i1 %more, label %columns, label %end",
        "end:",
        "  ret void",
        "}",
    ]
    return "\n".join(lines)


def _gather(wide: Number) -> str:
    load = f"call {wide.text} @llvm.masked.load.{wide.suffix}.p0"
    size = wide.bits // 8
    read = [
        f"  %r{j} = {load}(ptr %at{j}, i32 {size}, {wide.truth} %mask, {wide.text} zeroinitializer)"
        for j in range(BLOCK)
    ]
    lines, turned = _turned(wide, [f"%r{j}" for j in range(BLOCK)], "x")
    written = [f"  store {wide.text} {value}, ptr %to{k}, align {size}" for k, value in enumerate(turned)]
    return _columns("nbt.gather", wide, [*read, *lines, *written])


def _scatter(wide: Number) -> str:
    """Last row first: rows beyond the last state hold what that state has."""
    size = wide.bits // 8
    read = [f"  %r{k} = load {wide.text}, ptr %to{k}, align {size}" for k in range(BLOCK)]
    lines, turned = _turned(wide, [f"%r{k}" for k in range(BLOCK)], "x")
    store = f"call void @llvm.masked.store.{wide.suffix}.p0"
    written = [f"  {store}({wide.text} {turned[j]}, ptr %at{j}, i32 {size}, {wide.truth} %mask)" for j in range(BLOCK)]
    return _columns("nbt.scatter", wide, [*read, *lines, *written])


def _share(wide: Number) -> str:
    """One value for all lanes."""
    size = wide.bits // 8
    return f"""define internal void @nbt.share(ptr %array, i64 %size, ptr %lanes) nounwind {{
start:
  %some = icmp sgt i64 %size, 0
  br i1 %some, label %column, label %end
column:
  %c = phi i64 [0, %start], [%next, %column]
  %at = getelementptr {wide.element}, ptr %array, i64 %c
  %value = load {wide.element}, ptr %at, align {size}
  %one = insertelement {wide.text} poison, {wide.element} %value, i32 0
  %all = shufflevector {wide.text} %one, {wide.text} poison, <{BLOCK} x i32> zeroinitializer
  %lane = mul i64 %c, 8
  %to = getelementptr {wide.element}, ptr %lanes, i64 %lane
  store {wide.text} %all, ptr %to, align {size}
  %next = add i64 %c, 1
  %more = icmp slt i64 %next, %size
  br i1 %more, label %column, label %end
end:
  ret void
}}"""


def _group(way: str, element: str) -> str:
    """Reads one group of the job: its address, stride and size, and where its lanes are."""
    return f"""  %{way}.3 = mul i64 %{way}.k, 3
  %{way}.place = getelementptr i64, ptr %{way}.table, i64 %{way}.3
  %{way}.array = load ptr, ptr %{way}.place, align 8
  %{way}.place1 = getelementptr i64, ptr %{way}.place, i64 1
  %{way}.stride = load i64, ptr %{way}.place1, align 8
  %{way}.place2 = getelementptr i64, ptr %{way}.place, i64 2
  %{way}.size = load i64, ptr %{way}.place2, align 8
  %{way}.lane = mul i64 %{way}.column, 8
  %{way}.lanes = getelementptr {element}, ptr %{way}.memory, i64 %{way}.lane
  %{way}.column.next = add i64 %{way}.column, %{way}.size
  %{way}.k.next = add i64 %{way}.k, 1"""


def _results(wide: Number) -> str:
    """The output groups of one block."""
    element, size = wide.element, wide.bits // 8
    arguments = "i64 %out.stride, i64 %out.size, i64 %states, i64 %block, ptr %out.lanes"
    return f"""out:
  %out.k = phi i64 [0, %work], [%out.k.next, %out.end]
  %out.column = phi i64 [0, %work], [%out.column.next, %out.end]
  %out.more = icmp slt i64 %out.k, %out.count
  br i1 %out.more, label %out.group, label %done
out.group:
{_group("out", element)}
  %single = icmp eq i64 %out.stride, {size}
  %plain = and i1 %single, %full
  br i1 %plain, label %out.copy, label %out.scatter
out.copy:
  %values = load {wide.text}, ptr %out.lanes, align {size}
  %out.to = getelementptr {element}, ptr %out.array, i64 %first
  store {wide.text} %values, ptr %out.to, align {size}
  br label %out.end
out.scatter:
  call void @nbt.scatter(ptr %out.array, {arguments})
  br label %out.end
out.end:
  br label %out"""


def _driver(wide: Number) -> str:
    arguments = "i64 %in.stride, i64 %in.size, i64 %states, i64 %block, ptr %in.lanes"
    head = "ptr %function, ptr %job, ptr %in.memory, ptr %out.memory, i64 %begin, i64 %end"
    return f"""define void @{rows_name(wide)}({head}) nounwind {{
start:
  %states = load i64, ptr %job, align 8
  %job1 = getelementptr i64, ptr %job, i64 1
  %in.count = load i64, ptr %job1, align 8
  %job2 = getelementptr i64, ptr %job, i64 2
  %out.count = load i64, ptr %job2, align 8
  %in.table = getelementptr i64, ptr %job, i64 3
  %skip = mul i64 %in.count, 3
  %out.table = getelementptr i64, ptr %in.table, i64 %skip
  br label %blocks
blocks:
  %block = phi i64 [%begin, %start], [%block.next, %done]
  %first = mul i64 %block, {BLOCK}
  %behind = add i64 %first, {BLOCK}
  %full = icmp sle i64 %behind, %states
  %going = icmp slt i64 %block, %end
  br i1 %going, label %in, label %finish
in:
  %in.k = phi i64 [0, %blocks], [%in.k.next, %in.end]
  %in.column = phi i64 [0, %blocks], [%in.column.next, %in.end]
  %in.more = icmp slt i64 %in.k, %in.count
  br i1 %in.more, label %in.group, label %work
in.group:
{_group("in", wide.element)}
  %shared = icmp eq i64 %in.stride, 0
  br i1 %shared, label %in.share, label %in.gather
in.share:
  call void @nbt.share(ptr %in.array, i64 %in.size, ptr %in.lanes)
  br label %in.end
in.gather:
  call void @nbt.gather(ptr %in.array, {arguments})
  br label %in.end
in.end:
  br label %in
work:
  call void %function(ptr %in.memory, ptr %out.memory, i64 1)
  br label %out
{_results(wide)}
done:
  %block.next = add i64 %block, 1
  br label %blocks
finish:
  ret void
}}"""
