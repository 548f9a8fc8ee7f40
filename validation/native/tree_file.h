/* tree_file.h - reads a rigid tree as numbers, so that an engine needs no parser of URDF or YAML. C99 and C++.
 *
 *     symofros-tree 1
 *     gravity X Y Z                                 world frame
 *     bodies N
 *     body PARENT KIND AXIS(3) R_AP(9) p_AP(3) MASS p_BC(3) J_BC(9) MOMENTS(3) R_BM(9)    N times, parents first
 *
 * PARENT: index of the body that carries it, -1 for the ground. KIND: revolute, prismatic, ball, free. A: the parent's
 * frame, P: the joint's proximal frame, B: the body's, C: its mass centre, M: its principal axes there. SI, matrices
 * row by row; J_BC about C along the axes of B.
 */
#ifndef TREE_FILE_H
#define TREE_FILE_H

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct tree_body {
    int parent;
    char kind[16];
    double axis[3], R_AP[9], p_AP[3];
    double mass, p_BC[3], J_BC[9], moments[3], R_BM[9];
} tree_body;

typedef struct tree_file {
    double gravity[3];
    int n;
    tree_body *bodies;
} tree_file;

static int tree_numbers(FILE *file, double *values, int n) {
    int i;
    for (i = 0; i < n; ++i) {
        if (fscanf(file, "%lf", &values[i]) != 1) return 0;
    }
    return 1;
}

static int tree_read_body(FILE *file, tree_body *b) {
    return fscanf(file, " body %d %15s", &b->parent, b->kind) == 2 && tree_numbers(file, b->axis, 3) &&
           tree_numbers(file, b->R_AP, 9) && tree_numbers(file, b->p_AP, 3) && tree_numbers(file, &b->mass, 1) &&
           tree_numbers(file, b->p_BC, 3) && tree_numbers(file, b->J_BC, 9) && tree_numbers(file, b->moments, 3) &&
           tree_numbers(file, b->R_BM, 9);
}

static int tree_read_open(FILE *file, tree_file *tree) {
    int version, i;
    if (fscanf(file, " symofros-tree %d gravity", &version) != 1 || version != 1) return 0;
    if (!tree_numbers(file, tree->gravity, 3) || fscanf(file, " bodies %d", &tree->n) != 1 || tree->n < 0) return 0;
    tree->bodies = (tree_body *)calloc((size_t)tree->n + 1, sizeof *tree->bodies);
    if (tree->bodies == NULL) return 0;
    for (i = 0; i < tree->n; ++i) {
        if (!tree_read_body(file, &tree->bodies[i])) return 0;
    }
    return 1;
}

/* 1 if the file was read whole; free(tree->bodies) in either case. */
static int tree_read(const char *path, tree_file *tree) {
    FILE *file = fopen(path, "r");
    int whole;
    tree->bodies = NULL;
    if (file == NULL) return 0;
    whole = tree_read_open(file, tree);
    fclose(file);
    return whole;
}

static int tree_is(const tree_body *body, const char *kind) { return strcmp(body->kind, kind) == 0; }

#endif
