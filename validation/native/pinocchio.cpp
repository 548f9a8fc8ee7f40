// Pinocchio's side of a timing: its C++ algorithms, header-only, on a model built from a tree file.
//
// variant: the convention crba works in, "local" (Pinocchio's default) or "world".

#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/rnea.hpp>

#include <cstdio>
#include <cstring>
#include <exception>
#include <memory>
#include <string>

#include "contestant.h"
#include "tree_file.h"

namespace pin = pinocchio;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

using Rows = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

struct Side {
    pin::Model model;
    std::unique_ptr<pin::Data> data;
    pin::Convention convention;
};

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

const Side &side_of(void *self) { return *static_cast<const Side *>(self); }

Eigen::Map<const VectorXd> row(const double *array, size_t i, int size) {
    return Eigen::Map<const VectorXd>(array + i * size, size);
}

// crba computes the upper half of M.
void store_matrix(const Side &side, size_t i, double *M) {
    const int n = side.model.nv;
    Eigen::Map<Square>(M + i * n * n, n, n) = Eigen::MatrixXd(side.data->M.selfadjointView<Eigen::Upper>());
}

void store_bias(const Side &side, size_t i, double *h) {
    const int n = side.model.nv;
    Eigen::Map<VectorXd>(h + i * n, n) = side.data->nle;
}

void mass_matrix(void *self, size_t n, const double *const *in, double *const *out) {
    const Side &side = side_of(self);
    for (size_t i = 0; i < n; ++i) {
        pin::crba(side.model, *side.data, row(in[0], i, side.model.nq), side.convention);
        if (out) store_matrix(side, i, out[0]);
    }
}

void bias(void *self, size_t n, const double *const *in, double *const *out) {
    const Side &side = side_of(self);
    for (size_t i = 0; i < n; ++i) {
        pin::nonLinearEffects(side.model, *side.data, row(in[0], i, side.model.nq), row(in[1], i, side.model.nv));
        if (out) store_bias(side, i, out[0]);
    }
}

void mass_matrix_and_bias(void *self, size_t n, const double *const *in, double *const *out) {
    const Side &side = side_of(self);
    for (size_t i = 0; i < n; ++i) {
        const auto q = row(in[0], i, side.model.nq);
        pin::crba(side.model, *side.data, q, side.convention);
        pin::nonLinearEffects(side.model, *side.data, q, row(in[1], i, side.model.nv));
        if (out) {
            store_matrix(side, i, out[0]);
            store_bias(side, i, out[1]);
        }
    }
}

}  // namespace

void *contestant_open(const char *path, const char *variant, char *error, size_t size) {
    tree_file tree;
    std::unique_ptr<Side> side(new Side);
    const bool whole = tree_read(path, &tree);
    try {
        if (whole) build(tree, side->model);
        side->data.reset(new pin::Data(side->model));
    } catch (const std::exception &failure) {
        std::snprintf(error, size, "%s", failure.what());
        side.reset();
    }
    std::free(tree.bodies);
    if (!whole) std::snprintf(error, size, "the tree file can't be read");
    if (!whole || !side) return nullptr;
    side->convention = std::strcmp(variant, "world") == 0 ? pin::Convention::WORLD : pin::Convention::LOCAL;
    return side.release();
}

contestant_function *contestant_find(void *, const char *name) {
    if (std::strcmp(name, "mass_matrix") == 0) return mass_matrix;
    if (std::strcmp(name, "bias") == 0) return bias;
    if (std::strcmp(name, "mass_matrix_and_bias") == 0) return mass_matrix_and_bias;
    return nullptr;
}
