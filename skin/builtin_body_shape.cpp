#include "skin/builtin_body_shape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace toile::skin {
namespace {

constexpr size_t most_parts = 40;
constexpr double widest_blend = 0.1;  // [m]

const Eigen::Vector3d forward = Eigen::Vector3d::UnitZ();
const Eigen::Vector3d up = Eigen::Vector3d::UnitY();

/// Thickens sections by `side` across and `depth` from front to back.
std::vector<Section> thickened(std::vector<Section> sections, double side, double depth) {
    for (Section& section : sections) {
        section.side *= side;
        section.shift_side *= side;
        section.front *= depth;
        section.back *= depth;
        section.shift_front *= depth;
    }
    return sections;
}

std::vector<Section> thickened(std::vector<Section> sections, double by) {
    return thickened(std::move(sections), by, by);
}

ImplicitColumn ellipsoid(const Eigen::Vector3d& center, const Eigen::Vector3d& radius, const Eigen::Vector3d& along) {
    const double middle = 1e-3;
    return {{center, along, forward},
            {{-middle, radius[0], radius[2], radius[2]}, {middle, radius[0], radius[2], radius[2]}},
            {radius[1], radius[1]}};
}

}  // namespace

BuiltinJoints builtin_joints(double girth) {
    const double shoulder = std::pow(girth, 0.6), hip = std::pow(girth, 0.7);
    BuiltinJoints joint;
    joint.pelvis = {0, 0.955, -0.005};
    joint.spine = {0, 1.07, -0.02};
    joint.chest = {0, 1.22, -0.025};
    joint.neck = {0, 1.47, -0.025};
    joint.head = {0, 1.565, 0.0};
    joint.clavicle = {0.022, 1.425, 0.012};
    joint.upper_arm = {0.172 * shoulder, 1.402, -0.018};
    const Eigen::Vector3d arm = Eigen::Vector3d(1.0, -1.0, 0.06).normalized();
    joint.lower_arm = joint.upper_arm + 0.285 * arm;
    joint.hand = joint.lower_arm + 0.25 * arm;
    joint.fingertip = joint.hand + 0.19 * arm;
    joint.upper_leg = {0.099 * hip, 0.915, -0.005};
    joint.lower_leg = {0.115 * hip, 0.490, 0.0};
    joint.foot = {0.128 * hip, 0.075, -0.03};
    joint.toe = joint.foot + Eigen::Vector3d(0.025, -0.05, 0.15);
    return joint;
}

BuiltinShape::BuiltinShape(double girth) : girth_(girth), joint_(builtin_joints(girth)) {
    add_trunk();
    add_legs();
    add_head();
    add_arms();
}

void BuiltinShape::add(const ImplicitColumn& column, double blend) {
    part_.push_back({{column}, blend, blend});
}

void BuiltinShape::add_pair(const ImplicitColumn& column, double between, double blend) {
    part_.push_back({{column, column.mirrored()}, between, blend});
}

void BuiltinShape::add_trunk() {
    const double g = girth_;
    add({{{0, 0, -0.01}, up, forward},
         thickened({{0.89, 0.122, 0.066, 0.074},
                    {0.92, 0.136, 0.078, 0.085},
                    {0.96, 0.150, 0.091, 0.092},
                    {1.00, 0.153, 0.097, 0.092},
                    {1.05, 0.147, 0.099, 0.085},
                    {1.10, 0.143, 0.100, 0.080},
                    {1.16, 0.145, 0.103, 0.086},
                    {1.22, 0.156, 0.110, 0.101},
                    {1.28, 0.166, 0.111, 0.112},
                    {1.33, 0.161, 0.100, 0.112},
                    {1.38, 0.140, 0.074, 0.100},
                    {1.42, 0.105, 0.054, 0.082},
                    {1.45, 0.070, 0.040, 0.064}},
                   g),
         {0.080, 0.03},
         2.35},
        0.01);
    // Chest muscle, shoulder blades and seat.
    add_pair(ellipsoid({0.073 * g, 1.300, 0.027 * g}, {0.075 * g, 0.072, 0.060 * g}, up), 0.07, 0.05);
    add_pair(ellipsoid({0.080 * g, 1.315, -0.043 * g}, {0.070 * g, 0.095, 0.062 * g}, up), 0.07, 0.05);
    add_pair(ellipsoid({0.074 * g, 0.900, -0.060 * g}, {0.074 * g, 0.085, 0.062 * g}, up), 0.03, 0.07);
}

void BuiltinShape::add_legs() {
    const Eigen::Vector3d hip = joint_.upper_leg, ankle = joint_.foot;
    add_pair({{hip, ankle - hip, forward},
              thickened({{-0.02, 0.074, 0.079, 0.079},
                         {0.01, 0.078, 0.082, 0.081, 0.002},
                         {0.08, 0.084, 0.088, 0.086, 0.002},
                         {0.15, 0.080, 0.089, 0.083, 0.002},
                         {0.25, 0.071, 0.082, 0.074},
                         {0.34, 0.061, 0.070, 0.061},
                         {0.41, 0.054, 0.060, 0.054},
                         {0.45, 0.052, 0.056, 0.052},
                         {0.50, 0.053, 0.050, 0.060, 0.002},
                         {0.56, 0.056, 0.047, 0.071, 0.004},
                         {0.62, 0.053, 0.045, 0.067, 0.003},
                         {0.70, 0.041, 0.040, 0.050},
                         {0.77, 0.032, 0.034, 0.038},
                         {0.83, 0.029, 0.032, 0.034}},
                        girth_),
              {0.10, 0.03}},
             0.03, 0.08);
    // The foot lies along its sole.
    const double f = std::pow(girth_, 0.3);
    const Eigen::Vector3d heel = {ankle[0] - 0.006, 0.0, ankle[2] - 0.037};
    add_pair({{heel, {0.16, 0, 1}, up},
              thickened({{0.000, 0.026, 0.028, 0.034, 0, 0.036},
                         {0.040, 0.030, 0.030, 0.037, 0, 0.037},
                         {0.085, 0.034, 0.036, 0.036, 0, 0.036},
                         {0.140, 0.041, 0.031, 0.027, 0, 0.027},
                         {0.180, 0.044, 0.022, 0.021, 0, 0.021},
                         {0.212, 0.039, 0.015, 0.016, 0, 0.016}},
                        f, 1.0),
              {0.022, 0.025},
              2.4},
             0.03, 0.045);
}

void BuiltinShape::add_head() {
    const double h = std::pow(girth_, 0.2), n = std::pow(girth_, 0.6);
    const Eigen::Vector3d throat(0, 1.40, -0.03);
    add({{throat, Eigen::Vector3d(0, 1.58, 0.002) - throat, forward},
         thickened({{0.00, 0.078, 0.056, 0.066},
                    {0.06, 0.060, 0.055, 0.058},
                    {0.11, 0.054, 0.055, 0.054},
                    {0.18, 0.054, 0.057, 0.056}},
                   n),
         {0.05, 0.05}},
        0.05);
    add({{{0, 0, 0.014}, up, forward},
         thickened({{1.534, 0.026, 0.024, 0.030, 0, 0.056},
                    {1.552, 0.042, 0.044, 0.055, 0, 0.042},
                    {1.580, 0.056, 0.063, 0.072, 0, 0.025},
                    {1.610, 0.066, 0.076, 0.086, 0, 0.013},
                    {1.640, 0.073, 0.083, 0.096, 0, 0.005},
                    {1.660, 0.075, 0.086, 0.100, 0, 0.000},
                    {1.666, 0.075, 0.086, 0.100, 0, 0.000}},
                   h),
         {0.012, 0.086},
         2.15},
        0.035);
    add(ellipsoid({0, 1.618, 0.096 * h}, {0.012, 0.026, 0.019}, {0, 1, -0.25}), 0.024);
}

void BuiltinShape::add_arms() {
    const Eigen::Vector3d shoulder = joint_.upper_arm, arm = joint_.lower_arm - shoulder;
    const double n = std::pow(girth_, 0.6);
    const Eigen::Vector3d nape(0.03, 1.455, -0.03);
    add_pair({{nape, shoulder + Eigen::Vector3d(-0.015, 0.003, 0) - nape, forward},
              thickened({{0.00, 0.040, 0.038, 0.040}, {0.07, 0.042, 0.050, 0.052}, {0.12, 0.043, 0.052, 0.052}}, n),
              {0.03, 0.04}},
             0.03, 0.06);
    add_pair({{shoulder, arm, forward},
              thickened({{-0.01, 0.040, 0.047, 0.047, -0.006},
                         {0.03, 0.046, 0.053, 0.053, -0.004},
                         {0.07, 0.050, 0.055, 0.055, -0.001},
                         {0.12, 0.049, 0.053, 0.053},
                         {0.17, 0.046, 0.050, 0.049},
                         {0.22, 0.042, 0.046, 0.044},
                         {0.27, 0.037, 0.040, 0.040},
                         {0.30, 0.037, 0.040, 0.040},
                         {0.35, 0.040, 0.043, 0.041},
                         {0.42, 0.035, 0.038, 0.036},
                         {0.49, 0.026, 0.031, 0.029},
                         {0.535, 0.021, 0.027, 0.026}},
                        girth_),
              {0.045, 0.03}},
             0.03, 0.045);
    const double f = std::pow(girth_, 0.3);
    const Eigen::Vector3d thumb = joint_.hand + 0.035 * arm.normalized() + Eigen::Vector3d(0, 0, 0.018);
    add_pair({{joint_.hand, arm, forward},
              thickened({{0.000, 0.020, 0.026, 0.025},
                         {0.040, 0.019, 0.035, 0.034, -0.002},
                         {0.080, 0.018, 0.041, 0.040, -0.004},
                         {0.120, 0.015, 0.037, 0.037, -0.009},
                         {0.155, 0.012, 0.029, 0.029, -0.017}},
                        f),
              {0.03, 0.03},
              2.3},
             0.03, 0.02);
    add_pair({{thumb, arm.normalized() + Eigen::Vector3d(-0.1, -0.1, 0.75), forward},
              thickened({{0.00, 0.014, 0.014, 0.014}, {0.05, 0.012, 0.012, 0.012}}, f),
              {0.015, 0.014}},
             0.03, 0.02);
}

double BuiltinShape::distance(const Eigen::Vector3d& point) const {
    // Most of the box is far from most parts: their bounds decide there.
    std::array<double, most_parts> bound;
    double least = std::numeric_limits<double>::max();
    for (size_t i = 0; i < part_.size(); ++i) {
        bound[i] = std::numeric_limits<double>::max();
        for (const ImplicitColumn& column : part_[i].column)
            bound[i] = std::min(bound[i], column.distance_bound(point));
        least = std::min(least, bound[i]);
    }
    if (least > widest_blend) return least;
    double distance = std::max(least, 0.0) + 3.0 * widest_blend;
    for (size_t i = 0; i < part_.size(); ++i) {
        if (bound[i] > distance + part_[i].blend) continue;
        double part = part_[i].column.front().distance(point);
        if (part_[i].column.size() == 2)
            part = smooth_union(part, part_[i].column.back().distance(point), part_[i].between);
        // To first order a part can seem nearer than its bound; then skipping it just beyond would show as a step.
        distance = smooth_union(distance, std::max(part, bound[i]), part_[i].blend);
    }
    return distance;
}

Eigen::Vector3d BuiltinShape::lower() const {
    return {-upper()[0], -0.06, -0.14 - 0.14 * girth_};
}
Eigen::Vector3d BuiltinShape::upper() const {
    return {joint_.fingertip[0] + 0.08, 1.82, 0.16 + 0.14 * girth_};
}

}  // namespace toile::skin
