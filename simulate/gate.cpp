#include "simulate/gate.h"

namespace toile::simulate {
namespace {

template <class Value, class Bound>
bool within(Value value, const std::optional<Bound>& bound) {
    return !bound || value <= *bound;
}

}  // namespace

GateOptions gate_of(GateProfile profile) {
    GateOptions gate;
    gate.profile = profile;
    switch (profile) {
        case GateProfile::strict:
            break;
        case GateProfile::paper:
            gate.body_penetration = 0.001;
            gate.self_intersections.reset();
            break;
        case GateProfile::garmentcode:
            gate.residual_force.reset();
            gate.max_speed.reset();
            gate.moving_share = 0.015;
            gate.body_penetration.reset();
            gate.body_crossings = 35;
            gate.self_intersections = 300;
            gate.max_stretch.reset();
            break;
    }
    return gate;
}

DrapeStatus judge(const Certificate& certificate, bool finite, const GateOptions& gate) {
    if (!finite) return DrapeStatus::not_finite;
    if (!within(certificate.residual_force, gate.residual_force)) return DrapeStatus::not_at_rest;
    if (!within(certificate.max_speed, gate.max_speed)) return DrapeStatus::not_at_rest;
    if (!within(certificate.moving_share, gate.moving_share)) return DrapeStatus::not_at_rest;
    if (!within(certificate.body_penetration, gate.body_penetration)) return DrapeStatus::penetrates_body;
    if (!within(certificate.body_crossings, gate.body_crossings)) return DrapeStatus::penetrates_body;
    if (!within(certificate.self_intersections, gate.self_intersections)) return DrapeStatus::self_intersects;
    if (!within(certificate.max_stretch, gate.max_stretch)) return DrapeStatus::overstretched;
    return DrapeStatus::accepted;
}

std::map<std::string, double> gate_bounds(const GateOptions& gate) {
    std::map<std::string, double> bound;
    const auto add = [&](const char* name, const auto& value) {
        if (value) bound[name] = static_cast<double>(*value);
    };
    add("residual_force", gate.residual_force);
    add("max_speed", gate.max_speed);
    add("moving_share", gate.moving_share);
    add("body_penetration", gate.body_penetration);
    add("body_crossings", gate.body_crossings);
    add("self_intersections", gate.self_intersections);
    add("max_stretch", gate.max_stretch);
    return bound;
}

}  // namespace toile::simulate
