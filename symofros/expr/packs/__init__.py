"""Packs: scalars of one state formed by the same operations, so that generated code may use a vector for them.

A pack has WIDTH lanes and an edge of the graph in each. Lane l of a linear combination is

    x[l] = a y[l] + b z[l] + ...        with the same factors a, b, ... in all lanes,                          (1)

where y, z are packs, too. The graph stays one of scalars, which is what the interpreter, the operation counts and
batches see; a pack only records that some of its nodes are (1), and may always be left out.

What makes a pack valid (check.py, after each pass):

1. Exact: in each of its `exact_lanes`, the graph's scalar is (1) to the bit: the same products, added from the left.
   Where the graph folded a product of constants, a vector would round otherwise; such a lane is no exact lane.
2. Alive: each of its `new_lanes` is an exact lane that holds a computed node, no number and no input.
3. Distinct: no node is a new lane twice, be it of one pack or of two: it is read from one place.
4. Independent: with the new lanes of every pack contracted to one vertex, the dependences of the graph have no cycle.
   So no operand of a lane depends on another lane of the same pack, and no two packs wait for each other.

Validity follows from the operations alone. That nodes have been created in some order is used in two places, and in
neither for validity: linear_combination calls lanes new whose nodes it has just created, as operands are older and so
independent of them; and the emitter writes a vector where its `first_node` stands among the scalars.

A vector pays from `min_lanes` wanted lanes on; with fewer, putting lanes in and reading them costs more. This is the
emitter's choice for each function, and no matter of validity.

| step | module |
|---|---|
| state a pack lane by lane | pack.py: Pack, Pack.with_lane |
| create the linear combination (1), scalars included | combine.py: linear_combination; callers: the mass matrix, |
| | its factorisation, forward differentiation |
| copy packs with their nodes into another graph | carry.py: carry_packs; callers: copy_into, chain_sums |
| verify | check.py: check_packs, after each pass of generator/passes |
| choose what a function forms by vectors, and write C | generator/codegen/packs.py, as it is about C |
"""
