// Pinocchio's constrained dynamics as a loop over states, for loop.h: a tree, and the ties that close its loops.
//
// The ties are in a file beside the tree's, with ".ties" added: their number, then for each 3 (a point) or 6 (a frame),
// and twice the joint that carries it (0 for the ground), R(9) and p(3) of the place on it.

#include <pinocchio/algorithm/constrained-dynamics.hpp>

#include "pinocchio_tree.h"

namespace {

using Tie = pin::RigidConstraintModel;
using TieData = pin::RigidConstraintData;

struct Engine {
    pin::Model model;
    pin::Data data;
    std::vector<Tie, Eigen::aligned_allocator<Tie>> ties;
    std::vector<TieData, Eigen::aligned_allocator<TieData>> tie_data;
    // Conditions may repeat each other, which the proximal term copes with; enough steps for the last digits.
    pin::ProximalSettings settings{1e-12, 1e-8, 50};
};

bool read_place(FILE *file, pin::JointIndex &joint, pin::SE3 &place) {
    double numbers[12];
    unsigned long index;
    if (std::fscanf(file, "%lu", &index) != 1 || !tree_numbers(file, numbers, 12)) return false;
    joint = index;
    place = pin::SE3(matrix(numbers), vector(numbers + 9));
    return true;
}

bool read_ties(const std::string &path, Engine &engine) {
    FILE *file = std::fopen(path.c_str(), "r");
    int n = 0, kind = 0;
    bool whole = file != nullptr && std::fscanf(file, "%d", &n) == 1;
    for (int i = 0; whole && i < n; ++i) {
        pin::JointIndex first, second;
        pin::SE3 X1, X2;
        whole = std::fscanf(file, "%d", &kind) == 1 && read_place(file, first, X1) && read_place(file, second, X2);
        const pin::ContactType type = kind == 6 ? pin::CONTACT_6D : pin::CONTACT_3D;
        if (whole) engine.ties.emplace_back(type, engine.model, first, X1, second, X2, pin::LOCAL);
    }
    if (file != nullptr) std::fclose(file);
    return whole;
}

void forward_dynamics(Engine &e, const State &x) {
    pin::constraintDynamics(e.model, e.data, x.q, x.v, x.tau, e.ties, e.tie_data, e.settings);
}

double *give_a(Engine &e, double *to) { return put(to, e.data.ddq); }

}  // namespace

const loop_engine *loop_open(const char *path, int32_t) {
    tree_file tree;
    if (!tree_read(path, &tree)) return nullptr;
    Engine *engine = new Engine;
    build(tree, engine->model);
    std::free(tree.bodies);
    engine->data = pin::Data(engine->model);
    if (!read_ties(std::string(path) + ".ties", *engine)) return nullptr;
    for (const Tie &tie : engine->ties) engine->tie_data.push_back(tie.createData());
    pin::initConstraintDynamics(engine->model, engine->data, engine->ties, engine->tie_data);
    static loop_function functions[] = {
        {"forward_dynamics", "", 0, 0, run<Engine, forward_dynamics, give_a>},
    };
    functions[0].size = engine->model.nv;
    return new loop_engine{engine, 1, functions};
}
