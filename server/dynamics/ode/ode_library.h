// ODE's functions, from its shared library, which is loaded for the first world with this engine. Include
// this instead of ODE's header: within this namespace the names of ODE's functions are pointers to them.
#pragma once

#include <ode/ode.h>

#define VISUM_ODE_FUNCTIONS(F)        \
  F(dAllocateODEDataForThread)        \
  F(dBodyAddForce)                    \
  F(dBodyAddTorque)                   \
  F(dBodyCreate)                      \
  F(dBodyDisable)                     \
  F(dBodyEnable)                      \
  F(dBodyGetAngularVel)               \
  F(dBodyGetForce)                    \
  F(dBodyGetLinearVel)                \
  F(dBodyGetPosition)                 \
  F(dBodyGetQuaternion)               \
  F(dBodyGetRotation)                 \
  F(dBodySetAngularVel)               \
  F(dBodySetForce)                    \
  F(dBodySetGyroscopicMode)           \
  F(dBodySetKinematic)                \
  F(dBodySetLinearVel)                \
  F(dBodySetMass)                     \
  F(dBodySetPosition)                 \
  F(dBodySetQuaternion)               \
  F(dBodySetTorque)                   \
  F(dInitODE2)                        \
  F(dJointAddHingeTorque)             \
  F(dJointAddSliderForce)             \
  F(dJointAttach)                     \
  F(dJointCreateAMotor)               \
  F(dJointCreateBall)                 \
  F(dJointCreateContact)              \
  F(dJointCreateFixed)                \
  F(dJointCreateHinge)                \
  F(dJointCreateLMotor)               \
  F(dJointCreateSlider)               \
  F(dJointCreateUniversal)            \
  F(dJointGetHingeAngle)              \
  F(dJointGroupCreate)                \
  F(dJointGroupDestroy)               \
  F(dJointGroupEmpty)                 \
  F(dJointSetAMotorAxis)              \
  F(dJointSetAMotorNumAxes)           \
  F(dJointSetAMotorParam)             \
  F(dJointSetBallAnchor)              \
  F(dJointSetFeedback)                \
  F(dJointSetFixed)                   \
  F(dJointSetHingeAnchor)             \
  F(dJointSetHingeAxis)               \
  F(dJointSetHingeParam)              \
  F(dJointSetLMotorAxis)              \
  F(dJointSetLMotorNumAxes)           \
  F(dJointSetLMotorParam)             \
  F(dJointSetSliderAxis)              \
  F(dJointSetSliderParam)             \
  F(dJointSetUniversalAnchor)         \
  F(dJointSetUniversalAxis1)          \
  F(dJointSetUniversalAxis2)          \
  F(dMassSetParameters)               \
  F(dRandGetSeed)                     \
  F(dRandSetSeed)                     \
  F(dRfromQ)                          \
  F(dSetDebugHandler)                 \
  F(dSetErrorHandler)                 \
  F(dSetMessageHandler)               \
  F(dWorldCreate)                     \
  F(dWorldDestroy)                    \
  F(dWorldQuickStep)                  \
  F(dWorldSetAutoDisableFlag)         \
  F(dWorldSetCFM)                     \
  F(dWorldSetContactMaxCorrectingVel) \
  F(dWorldSetContactSurfaceLayer)     \
  F(dWorldSetERP)                     \
  F(dWorldSetGravity)                 \
  F(dWorldSetQuickStepNumIterations)  \
  F(dWorldStep)

namespace visum::dynamics::ode {

// Null until load_ode().
#define VISUM_ODE_POINTER(name) extern decltype(&::name) name;
VISUM_ODE_FUNCTIONS(VISUM_ODE_POINTER)
#undef VISUM_ODE_POINTER

// Sets the pointers. ensure_ode() calls it, once in a process. Throws std::runtime_error with the loader's
// reason where the library or one of the functions is missing.
void load_ode();

}  // namespace visum::dynamics::ode
