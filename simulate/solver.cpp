#include "simulate/solver.h"

#include "cloth/error.h"
#include "simulate/bullet_solver.h"
#include "simulate/implicit_solver.h"
#include "simulate/xpbd_solver.h"

namespace toile::simulate {

std::unique_ptr<Solver> make_solver(const DrapeModel& model, const std::vector<Contact*>& contacts,
                                    DrapeReport& report) {
    const std::string& name = model.scene.solver.solver;
    if (name == "implicit") return std::make_unique<ImplicitSolver>(model, contacts, report);
    if (name == "xpbd") return std::make_unique<XpbdSolver>(model, contacts, report);
    if (name == "bullet") return make_bullet_solver(model, contacts, report);
    throw Error("there is no solver \"" + name + "\"");
}

}  // namespace toile::simulate
