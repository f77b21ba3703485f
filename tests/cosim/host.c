/* A master in C: 20 steps of 1 s with 0.3 rad of rudder, then one that is refused; prints the states.

   host LIBRARY RESOURCES GUID; by the headers of FMI 2.0 that come with FMPy. */
#include <dlfcn.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

#include "fmi2FunctionTypes.h"

static void logger(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status,
                   fmi2String category, fmi2String message, ...)
{
    va_list values;
    va_start(values, message);
    fprintf(stderr, "%d ", status);
    vfprintf(stderr, message, values);
    fprintf(stderr, "\n");
    va_end(values);
}

#define FUNCTION(name) name##TYPE* name = (name##TYPE*)dlsym(library, #name)

int main(int count, char** words)
{
    void* library = dlopen(words[1], RTLD_NOW | RTLD_GLOBAL);
    if (!library) {
        fprintf(stderr, "%s\n", dlerror());
        return 1;
    }
    FUNCTION(fmi2Instantiate);
    FUNCTION(fmi2SetupExperiment);
    FUNCTION(fmi2EnterInitializationMode);
    FUNCTION(fmi2ExitInitializationMode);
    FUNCTION(fmi2SetReal);
    FUNCTION(fmi2GetReal);
    FUNCTION(fmi2DoStep);
    FUNCTION(fmi2Terminate);
    FUNCTION(fmi2FreeInstance);
    fmi2CallbackFunctions callbacks = {logger, calloc, free, NULL, NULL};
    fmi2Component ship =
        fmi2Instantiate("ship", fmi2CoSimulation, words[3], words[2], &callbacks, 0, 1);
    if (!ship) return 2;
    fmi2SetupExperiment(ship, 0, 0.0, 0.0, 0, 0.0);
    fmi2EnterInitializationMode(ship);
    fmi2ExitInitializationMode(ship);
    fmi2ValueReference rudder = 0, states[] = {2, 3, 4, 5, 6, 7, 8, 9};
    double order = 0.3, found[8];
    for (int k = 0; k < 20; k++) {
        fmi2SetReal(ship, &rudder, 1, &order);
        if (fmi2DoStep(ship, k, 1.0, 1) != fmi2OK) return 3;
    }
    fmi2GetReal(ship, states, 8, found);
    for (int k = 0; k < 8; k++) printf("%.17g\n", found[k]);
    order = 35.0;
    fmi2SetReal(ship, &rudder, 1, &order);
    if (fmi2DoStep(ship, 20.0, 1.0, 1) != fmi2Discard) return 4;
    fmi2GetReal(ship, states, 8, found);
    if (found[0] == found[0]) return 5; /* not nan: a refused step is to be seen */
    fmi2Terminate(ship);
    fmi2FreeInstance(ship);
    return 0;
}
