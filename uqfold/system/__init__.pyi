from uqfold.system.event import SystemEvent as SystemEvent
