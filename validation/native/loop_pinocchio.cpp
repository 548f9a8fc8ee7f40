// Pinocchio's C++ algorithms (header-only) as loops over states, for loop.h; the model comes as numbers, by tree_file.h.

#include <pinocchio/algorithm/aba-derivatives.hpp>
#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/frames.hpp>
#include <pinocchio/algorithm/rnea-derivatives.hpp>
#include <pinocchio/algorithm/rnea-second-order-derivatives.hpp>
#include <pinocchio/algorithm/rnea.hpp>

#include "pinocchio_tree.h"

namespace {

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
// Into tensors that Data has set to zero: it writes what is not zero in every state.
void inverse_second(Engine &e, const State &x) { pin::ComputeRNEASecondOrderDerivatives(e.model, e.data, x.q, x.v, x.a); }
void forward_derivatives(Engine &e, const State &x) { pin::computeABADerivatives(e.model, e.data, x.q, x.v, x.tau); }

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

double *put(double *to, const pin::Data::Tensor3x &tensor) {
    for (int i = 0; i < tensor.dimension(0); ++i)
        for (int j = 0; j < tensor.dimension(1); ++j)
            for (int k = 0; k < tensor.dimension(2); ++k) *to++ = tensor(i, j, k);
    return to;
}
double *give_second(Engine &e, double *to) {
    to = put(put(to, e.data.d2tau_dqdq), e.data.d2tau_dvdv);
    return put(put(to, e.data.d2tau_dqdv), e.data.d2tau_dadq);
}

std::vector<loop_function> functions(int nv) {
    constexpr pin::Convention local = pin::Convention::LOCAL, world = pin::Convention::WORLD;
    return {
        {"mass_matrix", "local", nv * nv, 0, run<Engine, mass_matrix<local>, give_M>},
        {"mass_matrix", "world", nv * nv, 0, run<Engine, mass_matrix<world>, give_M>},
        {"bias", "", nv, 0, run<Engine, bias, give_h>},
        {"dynamics", "local", nv * nv + nv, 0, run<Engine, dynamics<local>, give_both>},
        {"dynamics", "world", nv * nv + nv, 0, run<Engine, dynamics<world>, give_both>},
        {"forward_dynamics", "local", nv, 0, run<Engine, forward_dynamics<local>, give_a>},
        {"forward_dynamics", "world", nv, 0, run<Engine, forward_dynamics<world>, give_a>},
        {"inverse_dynamics", "", nv, 0, run<Engine, inverse_dynamics, give_tau>},
        {"frame_jacobian", "", 6 * nv, 0, run<Engine, frame_jacobian, give_J>},
        {"inverse_dynamics_derivatives", "", 2 * nv * nv, 0, run<Engine, inverse_derivatives, give_dtau>},
        {"inverse_dynamics_second_derivatives", "", 4 * nv * nv * nv, 0, run<Engine, inverse_second, give_second>},
        {"forward_dynamics_derivatives", "", 2 * nv * nv, 0, run<Engine, forward_derivatives, give_da>},
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
