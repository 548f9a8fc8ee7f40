// A tree of tree_file.h as Pinocchio's model, and the loop over states around its algorithms.
#ifndef PINOCCHIO_TREE_H
#define PINOCCHIO_TREE_H

#include <pinocchio/multibody.hpp>

#include <string>
#include <vector>

#include "loop.h"
#include "tree_file.h"

namespace pin = pinocchio;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

using Rows = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Row = Eigen::Map<const VectorXd>;

Matrix3d matrix(const double *entries) { return Eigen::Map<const Rows>(entries); }
Vector3d vector(const double *entries) { return Eigen::Map<const Vector3d>(entries); }

// The specialised joint models for axes x, y, z, as Pinocchio's own URDF reader chooses them.
pin::JointModel joint_model(const tree_body &body) {
    const Vector3d axis = vector(body.axis);
    const bool slides = tree_is(&body, "prismatic");
    if (tree_is(&body, "free")) return pin::JointModelFreeFlyer();
    if (tree_is(&body, "ball")) return pin::JointModelSpherical();
    if (axis == Vector3d::UnitX()) return slides ? pin::JointModel(pin::JointModelPX()) : pin::JointModelRX();
    if (axis == Vector3d::UnitY()) return slides ? pin::JointModel(pin::JointModelPY()) : pin::JointModelRY();
    if (axis == Vector3d::UnitZ()) return slides ? pin::JointModel(pin::JointModelPZ()) : pin::JointModelRZ();
    if (slides) return pin::JointModelPrismaticUnaligned(axis);
    return pin::JointModelRevoluteUnaligned(axis);
}

void build(const tree_file &tree, pin::Model &model) {
    std::vector<pin::JointIndex> ids(1, 0);
    model.gravity.linear() = vector(tree.gravity);
    for (int i = 0; i < tree.n; ++i) {
        const tree_body &body = tree.bodies[i];
        const pin::SE3 placement(matrix(body.R_AP), vector(body.p_AP));
        ids.push_back(model.addJoint(ids[body.parent + 1], joint_model(body), placement, "j" + std::to_string(i)));
        const pin::Inertia inertia(body.mass, vector(body.p_BC), matrix(body.J_BC));
        model.appendBodyToJoint(ids.back(), inertia, pin::SE3::Identity());
    }
}

struct State {
    Row q, v, a, tau;
};

// Copies its results row by row; returns the end.
double *put(double *to, const RowMajor &rows) {
    Eigen::Map<RowMajor>(to, rows.rows(), rows.cols()) = rows;
    return to + rows.size();
}

// Engines have a model, and results where `Give` finds them.
template <class Engine, void (*Algorithm)(Engine &, const State &), double *(*Give)(Engine &, double *)>
void run(void *engine, const loop_states *s, size_t rounds, double *results) {
    Engine &e = *static_cast<Engine *>(engine);
    const int nq = e.model.nq, nv = e.model.nv;
    for (size_t r = 0; r < rounds; ++r) {
        for (size_t i = 0; i < s->n; ++i) {
            const State x{Row(s->q + i * nq, nq), Row(s->v + i * nv, nv), Row(s->a + i * nv, nv), Row(s->tau + i * nv, nv)};
            Algorithm(e, x);
            if (results != nullptr) results = Give(e, results);
        }
    }
}

}  // namespace

#endif
