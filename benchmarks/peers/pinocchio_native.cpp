// Efforts of open chains by Pinocchio's recursion, which this compiler builds for this machine.
#include <pinocchio/multibody.hpp>
#include <pinocchio/algorithm/rnea.hpp>

using namespace pinocchio;
typedef Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> Matrix;
typedef Eigen::Map<const Eigen::Vector3d> Vector;
typedef Eigen::Map<const Eigen::VectorXd> Column;

struct Chain {
    Model model;
    Data data;
};

// Revolute joints, each on the link before, about its own axis 0, 1 or 2, as Python's Chain says them.
extern "C" __attribute__((visibility("default"))) void *made(
    int n, const int *axes, const double *turned, const double *at, const double *masses,
    const double *centres, const double *inertias, const double *gravity)
{
    Model model;
    model.gravity.linear() = Vector(gravity);
    for (int i = 0; i < n; i++) {
        SE3 place(Matrix(turned + 9 * i), Vector(at + 3 * i));
        std::string name = "joint" + std::to_string(i);
        JointIndex joint = axes[i] == 0   ? model.addJoint(i, JointModelRX(), place, name)
                           : axes[i] == 1 ? model.addJoint(i, JointModelRY(), place, name)
                                          : model.addJoint(i, JointModelRZ(), place, name);
        Inertia body(masses[i], Vector(centres + 3 * i), Matrix(inertias + 9 * i));
        model.appendBodyToJoint(joint, body);
    }
    return new Chain{model, Data(model)};
}

// Efforts at instants, one after another; all arrays are (instants, joints).
extern "C" __attribute__((visibility("default"))) void efforts(
    void *chain, long instants, const double *q, const double *v, const double *a, double *out)
{
    Chain &known = *static_cast<Chain *>(chain);
    long n = known.model.nv;
    for (long i = 0; i < instants * n; i += n)
        Eigen::Map<Eigen::VectorXd>(out + i, n) =
            rnea(known.model, known.data, Column(q + i, n), Column(v + i, n), Column(a + i, n));
}
