#include "cloth/error.h"
#include "simulate/bullet_solver.h"

namespace toile::simulate {

std::unique_ptr<Solver> make_bullet_solver(const DrapeModel& /*model*/, const std::vector<Contact*>& /*contacts*/,
                                           DrapeReport& /*report*/) {
    throw Error("this build has no Bullet (-DTOILE_BULLET=OFF): choose another simulate.solver");
}

}  // namespace toile::simulate
