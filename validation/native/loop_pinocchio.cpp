// Pinocchio's C++ algorithms (header-only) as loops over states, for loop.h; the model comes as numbers, by tree_file.h.

#include <pinocchio/algorithm/aba-derivatives.hpp>
#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/rnea-derivatives.hpp>
#include <pinocchio/algorithm/rnea.hpp>

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

struct Engine {
    explicit Engine(const tree_file &tree, int body) {
        build(tree, model);
        frame = model.addFrame(pin::Frame("timed", body + 1, 0, pin::SE3::Identity(), pin::OP_FRAME), false);
        data = pin::Data(model);
        J = pin::Data::Matrix6x::Zero(6, model.nv);
    }
    pin::Model model;
    pin::Data data;
    pin::FrameIndex frame;
    pin::Data::Matrix6x J;
};

struct State {
    Row q, v, a, tau;
};

// What is timed: an algorithm at one state.
template <pin::Convention C>
void mass_matrix(Engine &e, const State &x) { pin::crba(e.model, e.data, x.q, C); }
void bias(Engine &e, const State &x) { pin::nonLinearEffects(e.model, e.data, x.q, x.v); }
template <pin::Convention C>
void dynamics(Engine &e, const State &x) { mass_matrix<C>(e, x), bias(e, x); }
template <pin::Convention C>
void forward_dynamics(Engine &e, const State &x) { pin::aba(e.model, e.data, x.q, x.v, x.tau, C); }
void inverse_dynamics(Engine &e, const State &x) { pin::rnea(e.model, e.data, x.q, x.v, x.a); }
void frame_jacobian(Engine &e, const State &x) {
    e.J.setZero();
    pin::computeFrameJacobian(e.model, e.data, x.q, e.frame, pin::LOCAL_WORLD_ALIGNED, e.J);
}
void inverse_derivatives(Engine &e, const State &x) { pin::computeRNEADerivatives(e.model, e.data, x.q, x.v, x.a); }
void forward_derivatives(Engine &e, const State &x) { pin::computeABADerivatives(e.model, e.data, x.q, x.v, x.tau); }

// Copies its results row by row; returns the end.
double *put(double *to, const RowMajor &rows) {
    Eigen::Map<RowMajor>(to, rows.rows(), rows.cols()) = rows;
    return to + rows.size();
}
double *give_M(Engine &e, double *to) {
    const Eigen::MatrixXd M = e.data.M.selfadjointView<Eigen::Upper>();
    return put(to, M);
}
double *give_h(Engine &e, double *to) { return put(to, e.data.nle); }
double *give_both(Engine &e, double *to) { return give_h(e, give_M(e, to)); }
double *give_a(Engine &e, double *to) { return put(to, e.data.ddq); }
double *give_tau(Engine &e, double *to) { return put(to, e.data.tau); }
double *give_J(Engine &e, double *to) { return put(to, e.J); }
double *give_dtau(Engine &e, double *to) { return put(put(to, e.data.dtau_dq), e.data.dtau_dv); }
double *give_da(Engine &e, double *to) { return put(put(to, e.data.ddq_dq), e.data.ddq_dv); }

template <void (*Algorithm)(Engine &, const State &), double *(*Give)(Engine &, double *)>
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

std::vector<loop_function> functions(int nv) {
    constexpr pin::Convention local = pin::Convention::LOCAL, world = pin::Convention::WORLD;
    return {
        {"mass_matrix", "local", nv * nv, 0, run<mass_matrix<local>, give_M>},
        {"mass_matrix", "world", nv * nv, 0, run<mass_matrix<world>, give_M>},
        {"bias", "", nv, 0, run<bias, give_h>},
        {"dynamics", "local", nv * nv + nv, 0, run<dynamics<local>, give_both>},
        {"dynamics", "world", nv * nv + nv, 0, run<dynamics<world>, give_both>},
        {"forward_dynamics", "local", nv, 0, run<forward_dynamics<local>, give_a>},
        {"forward_dynamics", "world", nv, 0, run<forward_dynamics<world>, give_a>},
        {"inverse_dynamics", "", nv, 0, run<inverse_dynamics, give_tau>},
        {"frame_jacobian", "", 6 * nv, 0, run<frame_jacobian, give_J>},
        {"inverse_dynamics_derivatives", "", 2 * nv * nv, 0, run<inverse_derivatives, give_dtau>},
        {"forward_dynamics_derivatives", "", 2 * nv * nv, 0, run<forward_derivatives, give_da>},
    };
}

}  // namespace

const loop_engine *loop_open(const char *path, int32_t body) {
    tree_file tree;
    if (!tree_read(path, &tree)) return nullptr;
    Engine *engine = new Engine(tree, body);
    auto *table = new std::vector<loop_function>(functions(engine->model.nv));
    std::free(tree.bodies);
    return new loop_engine{engine, static_cast<int32_t>(table->size()), table->data()};
}
