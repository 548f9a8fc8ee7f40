// Times generated C against Pinocchio's C++ algorithms (header-only) in one process, interleaved, over the same states.
//
// Arguments: tree file, states file, generated library whose batches are loops, its exported function, repeats, the same
// library with batches by vectors.
// Prints one line a function and side: "error FUNCTION VALUE" (largest relative difference), then
// "time FUNCTION SIDE REPEAT NANOSECONDS" for each repeat, per state.

#include <pinocchio/algorithm/crba.hpp>
#include <pinocchio/algorithm/rnea-derivatives.hpp>
#include <pinocchio/algorithm/rnea.hpp>

#include <dlfcn.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "symofros_model.h"
#include "tree_file.h"

namespace pin = pinocchio;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

using Rows = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

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

Eigen::Map<const VectorXd> row(const std::vector<double> &array, size_t i, int size) {
    return Eigen::Map<const VectorXd>(array.data() + i * size, size);
}

struct States {
    size_t n;
    std::vector<double> q, v;
};

bool read_states(const char *path, int nq, int nv, States &states) {
    FILE *file = std::fopen(path, "r");
    if (file == nullptr || std::fscanf(file, "%zu", &states.n) != 1) return false;
    for (size_t i = 0; i < states.n; ++i) {
        double x;
        for (int k = 0; k < nq + nv; ++k) {
            if (std::fscanf(file, "%lf", &x) != 1) return false;
            (k < nq ? states.q : states.v).push_back(x);
        }
    }
    std::fclose(file);
    return true;
}

// As many states as a batch by vectors is timed with: their results stay in the cache, as Pinocchio's do.
const size_t BLOCK = 64;

// Generated C behind symofros_model.h: one function over all states, by its batch.
class Generated {
  public:
    Generated(const sym_model *model, const char *name, const States &states) : function_(sym_find(model, name, nullptr)) {
        pre_.resize(model->npre + 1);
        model->init(model->par_default, pre_.data());
        zeros_.resize(model->nv + model->nu + 1);
        n_ = states.n;
        for (int i = 0; i < function_->n_in; ++i) {
            const std::string in = function_->in[i].name;
            in_.push_back(in == "pre" ? pre_.data() : in == "q" ? states.q.data() : in == "v" ? states.v.data() : zeros_.data());
            stride_.push_back(in == "q" || in == "v" ? function_->in[i].rows : 0);
        }
        for (int i = 0; i < function_->n_out; ++i) {
            results_.emplace_back(n_ * function_->out[i].rows * function_->out[i].cols + 1);
        }
        for (auto &result : results_) out_.push_back(result.data());
        work_.resize(function_->work + 1);
    }
    void run() { function_->batch(n_, in_.data(), stride_.data(), out_.data(), work_.data()); }
    // Block after block, each over the results of the one before.
    void run_in_blocks() {
        std::vector<const double *> in(in_);
        for (size_t first = 0; first < n_; first += BLOCK) {
            function_->batch(std::min(BLOCK, n_ - first), in.data(), stride_.data(), out_.data(), work_.data());
            for (size_t i = 0; i < in.size(); ++i) in[i] += BLOCK * stride_[i];
        }
    }
    const std::vector<double> &result(int i) const { return results_[i]; }

  private:
    const sym_function *function_;
    size_t n_;
    std::vector<double> pre_, zeros_, work_;
    std::vector<const double *> in_;
    std::vector<size_t> stride_;
    std::vector<std::vector<double>> results_;
    std::vector<double *> out_;
};

enum What { MASS_MATRIX, BIAS, BOTH, DERIVATIVES };

void pinocchio_run(const pin::Model &model, pin::Data &data, const States &states, What what, pin::Convention convention) {
    const VectorXd still = VectorXd::Zero(model.nv);
    for (size_t i = 0; i < states.n; ++i) {
        const auto q = row(states.q, i, model.nq);
        if (what == DERIVATIVES) {
            pin::computeRNEADerivatives(model, data, q, row(states.v, i, model.nv), still);
            continue;
        }
        if (what != BIAS) pin::crba(model, data, q, convention);
        if (what != MASS_MATRIX) pin::nonLinearEffects(model, data, q, row(states.v, i, model.nv));
    }
}

double worst(double error, double value, double reference, double scale) {
    const double own = std::abs(value - reference) / scale;
    return own > error || own != own ? own : error;
}

template <class Function>
double nanoseconds(const Function &function, size_t n) {
    const auto start = std::chrono::steady_clock::now();
    function();
    return std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - start).count() / double(n);
}

// The model of a library; null, with the reason in dlerror(), where there is none.
const sym_model *load(const char *path, const char *name) {
    void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    const auto symbol = library == nullptr ? nullptr : reinterpret_cast<const sym_model *(*)()>(dlsym(library, name));
    return symbol == nullptr ? nullptr : symbol();
}

}  // namespace

int main(int argc, char **argv) {
    if (argc != 7) return 2;
    tree_file tree;
    if (!tree_read(argv[1], &tree)) return std::fprintf(stderr, "the tree file can't be read\n"), 2;
    pin::Model model;
    build(tree, model);
    pin::Data data(model);
    States states;
    if (!read_states(argv[2], model.nq, model.nv, states)) return std::fprintf(stderr, "the states can't be read\n"), 2;
    const sym_model *one_by_one = load(argv[3], argv[4]), *by_vectors = load(argv[6], argv[4]);
    if (one_by_one == nullptr || by_vectors == nullptr) return std::fprintf(stderr, "%s\n", dlerror()), 2;

    Generated mass_matrix(one_by_one, "mass_matrix", states), bias(one_by_one, "bias", states);
    Generated both(one_by_one, "dynamics", states), batch(by_vectors, "dynamics", states);
    mass_matrix.run(), bias.run(), both.run(), batch.run();
    const int nv = model.nv;
    double error_M = 0.0, error_h = 0.0;
    for (size_t i = 0; i < states.n; ++i) {
        pin::crba(model, data, row(states.q, i, model.nq), pin::Convention::WORLD);
        pin::nonLinearEffects(model, data, row(states.q, i, model.nq), row(states.v, i, nv));
        const Eigen::MatrixXd M = data.M.selfadjointView<Eigen::Upper>();
        const double size_M = M.cwiseAbs().maxCoeff(), size_h = data.nle.cwiseAbs().maxCoeff();
        for (int j = 0; j < nv; ++j) {
            error_h = worst(error_h, bias.result(0)[i * nv + j], data.nle[j], size_h);
            error_h = worst(error_h, both.result(1)[i * nv + j], data.nle[j], size_h);
            error_h = worst(error_h, batch.result(1)[i * nv + j], data.nle[j], size_h);
            for (int k = 0; k < nv; ++k) {
                error_M = worst(error_M, mass_matrix.result(0)[(i * nv + j) * nv + k], M(j, k), size_M);
                error_M = worst(error_M, both.result(0)[(i * nv + j) * nv + k], M(j, k), size_M);
                error_M = worst(error_M, batch.result(0)[(i * nv + j) * nv + k], M(j, k), size_M);
            }
        }
    }
    std::printf("error mass_matrix %.3e\nerror bias %.3e\n", error_M, error_h);

    // Large models go without: their derivatives take long to compile.
    const char *names[] = {"mass_matrix", "bias", "mass_matrix_and_bias", "inverse_dynamics_derivatives"};
    const bool with_derivatives = sym_find(one_by_one, names[DERIVATIVES], nullptr) != nullptr;
    Generated derivatives(one_by_one, with_derivatives ? names[DERIVATIVES] : "bias", states);
    if (with_derivatives) {
        derivatives.run();
        double error = 0.0;
        for (size_t i = 0; i < states.n; ++i) {
            pin::computeRNEADerivatives(model, data, row(states.q, i, model.nq), row(states.v, i, nv), VectorXd::Zero(nv));
            const double size_q = data.dtau_dq.cwiseAbs().maxCoeff(), size_v = data.dtau_dv.cwiseAbs().maxCoeff();
            for (int j = 0; j < nv; ++j) {
                for (int k = 0; k < nv; ++k) {
                    error = worst(error, derivatives.result(0)[(i * nv + j) * nv + k], data.dtau_dq(j, k), size_q);
                    error = worst(error, derivatives.result(1)[(i * nv + j) * nv + k], data.dtau_dv(j, k), size_v);
                }
            }
        }
        std::printf("error inverse_dynamics_derivatives %.3e\n", error);
    }

    Generated *generated[] = {&mass_matrix, &bias, &both, &derivatives};
    const int repeats = std::atoi(argv[5]);
    for (int r = 0; r < repeats; ++r) {
        for (int f = 0; f < (with_derivatives ? 4 : 3); ++f) {
            const What what = What(f);
            const double ours = nanoseconds([&] { generated[f]->run(); }, states.n);
            const auto theirs = [&](pin::Convention c) {
                return nanoseconds([&] { pinocchio_run(model, data, states, what, c); }, states.n);
            };
            const auto print = [&](const char *suffix, const char *side, double time) {
                std::printf("time %s%s %s %d %.2f\n", names[f], suffix, side, r, time);
            };
            const double local = theirs(pin::Convention::LOCAL);
            print("", "symofros", ours), print("", "pinocchio-local", local);
            if (what == MASS_MATRIX || what == BOTH) {
                const double world = theirs(pin::Convention::WORLD);
                print("", "pinocchio-world", world);
                if (what == BOTH) {
                    print("_batch", "symofros", nanoseconds([&] { batch.run_in_blocks(); }, states.n));
                    print("_batch", "pinocchio-local", local), print("_batch", "pinocchio-world", world);
                }
            }
        }
    }
    return 0;
}
